// SPDX-License-Identifier: Apache-2.0
#include <Eigen/IterativeLinearSolvers>
#include <algorithm>

#include "body/assembly.hpp"
#include "cpu_reference/conjugate_gradient.hpp"
#include "cpu_reference/routes.hpp"
#include "sunder/error.hpp"

namespace sunder::cpu_reference {
namespace {

// Stops of conjugate gradients, in the norm of the preconditioner, relative to a solution from
// nothing and to a correction. What the first leaves a full check finds, and corrections remove.
constexpr double kSolution = 1e-10, kCorrection = 1e-3;
// Hundreds on a board, thousands where materials are extreme.
constexpr int kMostIterations = 20000;

}  // namespace

/// Lin and More 1999, with limits of their own against negative pivots.
class IncompleteFactor {
 public:
  explicit IncompleteFactor(const Problem& problem) {
    const linear_algebra::SparseMatrix lower = fem::assemble_lower(problem, {});
    entries_ = static_cast<std::size_t>(lower.nonZeros());
    factor_.compute(lower);
  }
  void apply(const Eigen::VectorXd& r, Eigen::VectorXd& z) const { z = factor_.solve(r); }
  [[nodiscard]] std::size_t bytes() const { return entries_ * (sizeof(double) + sizeof(Index)); }

 private:
  // In the order of the mesh: another one, made for a whole factor, costs iterations.
  Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::NaturalOrdering<Index>> factor_;
  std::size_t entries_ = 0;
};

namespace {

class IncompleteRoute final : public InverseRoute {
 public:
  IncompleteRoute(const DamagedBody& body, std::shared_ptr<const IncompleteFactor> preconditioner)
      : body_(body), preconditioner_(std::move(preconditioner)) {
    last_.setZero(body.problem().dof_count());
  }

  Applied solve(const Load& load, const Eigen::VectorXd& f, Eigen::VectorXd& u) override {
    u.setZero(last_.size());
    hold(u, load.displacements);
    const double scale = norm_squared(residual(f, u));
    u = last_;
    hold(u, load.displacements);
    Eigen::VectorXd du;
    const CgResult cg = run(residual(f, u), {.absolute = kSolution * kSolution * scale}, du);
    u += du;
    if (u.allFinite()) last_ = u;
    return {cg.iterations, cg.converged};
  }

  Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& u) override {
    const CgResult cg = run(r, {.relative = kCorrection * kCorrection}, u);
    return {cg.iterations, cg.converged};
  }

  void follow(const fem::Event&) override {}  // K u is computed element by element

  std::unique_ptr<solver::RouteState> state() const override {
    auto state = std::make_unique<State>();
    state->last = last_;
    return state;
  }
  bool go_back(const solver::RouteState& state, std::size_t) override {
    last_ = dynamic_cast<const State&>(state).last;
    return true;
  }

  std::vector<BufferPlan> buffers() const override {
    return {{"conjugate gradient vectors (6 n)",
             6 * static_cast<std::size_t>(last_.size()) * sizeof(double)},
            {"incomplete factor of the intact body", preconditioner_->bytes()}};
  }

 private:
  struct State final : solver::RouteState {
    Eigen::VectorXd last;
  };

  CgResult run(const Eigen::VectorXd& r, CgStop stop, Eigen::VectorXd& x) {
    stop.max_iterations = kMostIterations;
    return conjugate_gradient(
        [this](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
          body_.apply(in, out);
          clear_grips(out);
        },
        [this](const Eigen::VectorXd& in, Eigen::VectorXd& out) { precondition(in, out); }, r, stop,
        x);
  }

  /// Over the unknowns that no grip holds: in and out are zero at the others.
  void precondition(const Eigen::VectorXd& in, Eigen::VectorXd& out) const {
    preconditioner_->apply(in, out);
    clear_grips(out);
  }

  Eigen::VectorXd residual(const Eigen::VectorXd& f, const Eigen::VectorXd& u) {
    body_.apply(u, product_);
    Eigen::VectorXd r = f - product_;
    clear_grips(r);
    return r;
  }

  double norm_squared(const Eigen::VectorXd& r) const {
    Eigen::VectorXd z;
    precondition(r, z);
    return r.dot(z);
  }

  void hold(Eigen::VectorXd& u, std::span<const double> displacements) const {
    const auto grips = body_.forms().gripped();
    for (std::size_t g = 0; g < grips.size(); ++g) u[grips[g]] = displacements[g];
  }

  void clear_grips(Eigen::VectorXd& v) const {
    for (Index d : body_.forms().gripped()) v[d] = 0;
  }

  const DamagedBody& body_;
  std::shared_ptr<const IncompleteFactor> preconditioner_;
  Eigen::VectorXd last_;  // the last solution: where the next one begins
  Eigen::VectorXd product_;
};

}  // namespace

void NeverDamaged::solve(const Load& load, const Eigen::VectorXd& f, Eigen::VectorXd& x) const {
  if (route_->solve(load, f, x).converged) return;
  throw NumericalError(
      "conjugate gradients on the intact body did not converge; ease contrast, Poisson's ratio or "
      "slivers");
}

std::shared_ptr<const IncompleteFactor> incomplete_factor(const Problem& problem) {
  return std::make_shared<const IncompleteFactor>(problem);
}

std::unique_ptr<InverseRoute> incomplete_route(
    const DamagedBody& body, std::shared_ptr<const IncompleteFactor> preconditioner) {
  return std::make_unique<IncompleteRoute>(body, std::move(preconditioner));
}

}  // namespace sunder::cpu_reference
