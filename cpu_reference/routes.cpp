// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/routes.hpp"

#include <algorithm>
#include <numeric>
#include <thread>

#include "cpu_reference/conjugate_gradient.hpp"
#include "cpu_reference/low_rank.hpp"
#include "cpu_reference/stress.hpp"
#include "sunder/error.hpp"

namespace sunder::cpu_reference {
namespace {

// CG stops when the error's energy norm, measured in the intact body, is this share of the first
// guess's. Nine digits of stress along a crack need about 1e-11.
constexpr double kCgTolerance = 1e-12;
// For an error estimate two digits of the correction are enough (squared: an energy).
constexpr double kCorrection = 1e-4;

int machine_threads() {
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

class DenseInverseRoute final : public InverseRoute {
 public:
  DenseInverseRoute(const DamagedBody& body, const IntactBody& intact)
      : body_(body), grips_(intact.grips.dofs()), x_(intact.factor.inverse()), update_(x_.rows()) {
    grips_.read(x_);
  }

  Applied solve(const Load& load, const Eigen::VectorXd&, Eigen::VectorXd& u) override {
    u.setZero(x_.rows());
    for (std::size_t i = 0; i < load.forces.size(); ++i) {
      u += load.forces[i] * x_.col(load.force_dofs[i]);  // u = X f, loaded columns only
    }
    grips_.hold(u, load.displacements);
    return {};
  }

  Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& u) override {
    u.noalias() = x_ * r;
    grips_.hold(u, {});
    return {};
  }

  void destroy(std::span<const Index> elements) override {
    update_.gather(body_.problem(), elements);
    if (update_.apply(x_)) {
      grips_.read(x_);
    } else {  // rounding has made I - W^T X W indefinite
      rebase();
    }
  }

  bool rebase() override {
    x_ = fem::Factor(body_.problem(), body_.scale()).inverse();
    grips_.read(x_);
    return true;
  }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan{
        {"inverse (dense, n x n)", static_cast<std::size_t>(x_.size()) * sizeof(double)}};
    if (update_.bytes() > 0) plan.push_back({"room of the largest update", update_.bytes()});
    return plan;
  }

 private:
  const DamagedBody& body_;
  Grips grips_;
  Eigen::MatrixXd x_;
  InverseUpdate update_;
};

class ConjugateGradientRoute final : public InverseRoute {
 public:
  ConjugateGradientRoute(const DamagedBody& body, const IntactBody& intact)
      : body_(body), intact_(intact) {}

  Applied solve(const Load& load, const Eigen::VectorXd& f, Eigen::VectorXd& u) override {
    intact_.solve(f, load.displacements, u);  // the intact solution is the first guess
    body_.apply(u, product_);
    const double energy = u.dot(product_);
    Eigen::VectorXd r = f - product_, du;
    clear_grips(r);
    const CgResult cg = run(r, {.absolute = kCgTolerance * kCgTolerance * energy}, du);
    u += du;
    return {cg.iterations, cg.converged};
  }

  Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& u) override {
    const CgResult cg = run(r, {.relative = kCorrection}, u);
    return {cg.iterations, cg.converged};
  }

  void destroy(std::span<const Index>) override {}  // K u is computed element by element

  std::vector<BufferPlan> buffers() const override {
    return {{"conjugate gradient vectors (5 n)",
             5 * static_cast<std::size_t>(body_.problem().dof_count()) * sizeof(double)}};
  }

 private:
  CgResult run(const Eigen::VectorXd& r, const CgStop& stop, Eigen::VectorXd& x) {
    return conjugate_gradient(
        [this](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
          body_.apply(in, out);
          clear_grips(out);
        },
        [this](const Eigen::VectorXd& in, Eigen::VectorXd& out) { intact_.solve(in, {}, out); }, r,
        stop, x);
  }

  void clear_grips(Eigen::VectorXd& v) const {
    for (Index d : intact_.grips.dofs()) v[d] = 0;
  }

  const DamagedBody& body_;
  const IntactBody& intact_;
  Eigen::VectorXd product_;
};

}  // namespace

void Grips::set_columns(Eigen::MatrixXd columns) {
  columns_ = std::move(columns);
  factor();
}

void Grips::read(const Eigen::MatrixXd& inverse) {
  if (none()) return;
  columns_.resize(inverse.rows(), static_cast<Index>(dofs_.size()));
  for (std::size_t i = 0; i < dofs_.size(); ++i) {
    columns_.col(static_cast<Index>(i)) = inverse.col(dofs_[i]);
  }
  factor();
}

void Grips::factor() {
  at_grips_.resize(columns_.cols(), columns_.cols());
  for (Index i = 0; i < columns_.cols(); ++i) {
    at_grips_.row(i) = columns_.row(dofs_[static_cast<std::size_t>(i)]);
  }
  block_.compute(at_grips_);
  if (block_.info() != Eigen::Success) {
    throw NumericalError("the compliance of the gripped nodes is singular in double precision");
  }
}

void Grips::hold(Eigen::VectorXd& x, std::span<const double> displacement) const {
  if (none()) return;
  gap_.resize(static_cast<Index>(dofs_.size()));
  for (std::size_t i = 0; i < dofs_.size(); ++i) {
    gap_[static_cast<Index>(i)] = (displacement.empty() ? 0.0 : displacement[i]) - x[dofs_[i]];
  }
  block_.solveInPlace(gap_);
  x.noalias() += columns_ * gap_;
  for (std::size_t i = 0; i < dofs_.size(); ++i) {
    x[dofs_[i]] = displacement.empty() ? 0.0 : displacement[i];  // free of rounding
  }
}

DamagedBody::DamagedBody(std::shared_ptr<const Problem> problem) : problem_(std::move(problem)) {
  scale_.assign(problem_->mesh().tets.size(), 1.0);
  destroyed_.assign(scale_.size(), 0);
  nodal_in_.resize(problem_->dofs().size());
  nodal_out_.resize(nodal_in_.size());
}

void DamagedBody::destroy(std::span<const Index> elements) {
  for (Index e : elements) {
    scale_[e] = problem_->scene().fracture.alpha;
    destroyed_[e] = 1;
  }
}

void DamagedBody::apply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  fem::scatter(*problem_, {x.data(), static_cast<std::size_t>(x.size())}, nodal_in_);
  fem::apply_stiffness(*problem_, scale_, nodal_in_, nodal_out_);
  y.resize(x.size());
  fem::gather(*problem_, nodal_out_, {y.data(), static_cast<std::size_t>(y.size())});
}

double DamagedBody::largest_stress(const Eigen::VectorXd& x) const {
  fem::scatter(*problem_, {x.data(), static_cast<std::size_t>(x.size())}, nodal_in_);
  return cpu_reference::largest_stress(*problem_, destroyed_, nodal_in_);
}

double DamagedBody::largest_stress(const Eigen::VectorXd& x,
                                   std::span<const Index> elements) const {
  fem::scatter(*problem_, {x.data(), static_cast<std::size_t>(x.size())}, nodal_in_);
  return cpu_reference::largest_stress(*problem_, destroyed_, nodal_in_, elements);
}

IntactBody::IntactBody(const Problem& problem, bool rebases, const fem::Analysis& analysis)
    : factor(analysis.nodes, analysis.ordered, {.threads = machine_threads()}),
      grips(problem.gripped_dofs()) {
  if (rebases) {
    stiffness = std::make_unique<fem::OrderedStiffness>(problem, analysis.nodes, analysis.ordered);
  }
  if (!grips.none()) grips.set_columns(factor.inverse_columns(grips.dofs()));
}

void IntactBody::solve(const Eigen::VectorXd& f, std::span<const double> displacement,
                       Eigen::VectorXd& x) const {
  factor.solve(f, x, work_);
  grips.hold(x, displacement);
}

std::unique_ptr<InverseRoute> dense_inverse_route(const DamagedBody& body,
                                                  const IntactBody& intact) {
  return std::make_unique<DenseInverseRoute>(body, intact);
}

std::unique_ptr<InverseRoute> conjugate_gradient_route(const DamagedBody& body,
                                                       const IntactBody& intact) {
  return std::make_unique<ConjugateGradientRoute>(body, intact);
}

}  // namespace sunder::cpu_reference
