// SPDX-License-Identifier: Apache-2.0
// Route condensed with update eager: X_SS of the damaged body itself. An event between unknowns of
// S adds Z Z^T to it, as to the whole inverse; what u is elsewhere follows from the factor and the
// stiffness D that was lost since: u = X0 (f + D u).
#include <algorithm>
#include <array>

#include "cpu_reference/load_room.hpp"
#include "cpu_reference/low_rank.hpp"
#include "cpu_reference/routes.hpp"
#include "fem/element.hpp"
#include "sunder/error.hpp"

namespace sunder::cpu_reference {
namespace {

constexpr std::size_t kReserved = 1024;  // room for lost elements

class CondensedEagerRoute final : public InverseRoute {
 public:
  CondensedEagerRoute(const DamagedBody& body, const IntactBody& intact,
                      std::span<const Index> dofs)
      : body_(body),
        factor_(std::shared_ptr<void>(), &intact.factor),  // without an owner: it outlives this
        intact_(&intact.factor),
        place_(static_cast<std::size_t>(body.problem().dof_count()), kNone),
        gripped_(body.problem().gripped_dofs()),
        update_(static_cast<Eigen::Index>(dofs.size())) {
    reserve(load_, body.problem());
    dofs_.reserve(dofs.size());
    for (Index d : dofs) add_unknown(d);
    x_ = factor_->inverse_block(dofs_, dofs_);
    lost_.reserve(std::min(body.scale().size(), kReserved));
    factor_grips();
  }

  Applied solve(const Load& load, const Eigen::VectorXd& f, Eigen::VectorXd& u) override {
    load_ = load;
    if (std::ranges::all_of(load.force_dofs, [this](Index d) { return place_[d] != kNone; })) {
      u_.setZero(x_.rows());
      for (std::size_t i = 0; i < load.forces.size(); ++i) {
        u_ += load.forces[i] * x_.col(place_[load.force_dofs[i]]);
      }
    } else {
      apply_everywhere(f);
    }
    hold(load.displacements);
    if (u.size() != f.size()) u.setZero(f.size());
    spread(u);
    return {};
  }

  Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& u) override {
    apply_everywhere(r);
    hold({});
    right_side_ = r;
    add_to(right_side_);
    factor_->solve(right_side_, u, work_);
    spread(u);
    return {};
  }

  void complete(Eigen::VectorXd& u) override {
    right_side_.setZero(u.size());
    for (std::size_t i = 0; i < load_.forces.size(); ++i) {
      right_side_[load_.force_dofs[i]] = load_.forces[i];
    }
    add_to(right_side_);
    factor_->solve(right_side_, u, work_);
    spread(u);
  }

  bool equilibrium(engine::Equilibrium& of) const override {
    of.factor = factor_;
    of.dofs.assign(load_.force_dofs.begin(), load_.force_dofs.end());
    of.forces.assign(load_.forces.begin(), load_.forces.end());
    const auto add = [&of](Index dof, double force) {
      of.dofs.push_back(dof);
      of.forces.push_back(force);
    };
    for (std::size_t g = 0; g < gripped_.size(); ++g) add(gripped_[g], grip_force(g));
    for (std::size_t i = 0; i < dofs_.size(); ++i) {
      const double force = lost_forces_[static_cast<Eigen::Index>(i)];
      if (force != 0) add(dofs_[i], force);
    }
    of.lost = nullptr;
    of.lost_u.clear();
    return true;
  }

  void destroy(std::span<const Index> elements) override {
    ++bases_;
    const std::span<Index> touched = update_.gather(body_.problem(), elements);
    grow(touched);
    for (Index& d : touched) d = place_[d];
    if (update_.apply(x_) && factor_grips()) {
      for (Index e : elements) lose(e);
    } else {  // rounding has made I - W^T X W indefinite
      rebase();
    }
  }

  bool rebase() override {
    factor_ = std::make_shared<const fem::Factor>(body_.problem(), body_.scale());
    x_ = factor_->inverse_block(dofs_, dofs_);
    lost_.clear();
    ++bases_;
    if (!factor_grips()) {
      throw NumericalError("the compliance of the gripped nodes is singular in double precision");
    }
    return true;
  }

  double grip_force(std::size_t g) const override { return grip_[static_cast<Eigen::Index>(g)]; }
  /// An inverse that was written over is another base.
  int bases() const override { return bases_; }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan{{"condensed inverse (dense, |S| x |S|)",
                                  static_cast<std::size_t>(x_.size()) * sizeof(double)}};
    if (update_.bytes() > 0) plan.push_back({"room of the largest update", update_.bytes()});
    if (!lost_.empty()) {
      plan.push_back({"stiffness lost since the factor", lost_.size() * sizeof(LostElement)});
    }
    if (factor_.get() != intact_) {
      plan.push_back({"damaged factor (sparse Cholesky)", factor_->bytes()});
    }
    return plan;
  }

 private:
  struct LostElement {
    std::array<Index, 12> places;  // in S, kNone: held
    fem::UpdateFactor u;           // D_e = u u^T
  };

  void add_unknown(Index d) {
    place_[d] = static_cast<Index>(dofs_.size());
    dofs_.push_back(d);
  }

  void lose(Index e) {
    const Problem& problem = body_.problem();
    const Material& m = problem.material(e);
    LostElement& lost = lost_.emplace_back();
    lost.u = fem::update_factor(problem.shape(e), fem::elasticity(m.young, m.poisson),
                                problem.scene().fracture.alpha);
    for (std::size_t i = 0; i < 12; ++i) {
      const Index d = problem.dof(problem.mesh().tets[e][i / 3], static_cast<int>(i % 3));
      lost.places[i] = d == kNone ? kNone : place_[d];
    }
  }

  /// y = D u, both on S.
  void multiply_lost(const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd& y) const {
    y.setZero(u.size());
    Eigen::Matrix<double, 12, 1> corners;
    for (const LostElement& lost : lost_) {
      for (Eigen::Index i = 0; i < 12; ++i) {
        const Index p = lost.places[static_cast<std::size_t>(i)];
        corners[i] = p == kNone ? 0.0 : u[p];
      }
      // From the first corner: the columns of u^T add up to nothing on each axis.
      for (Eigen::Index i = 3; i < 12; ++i) corners[i] -= corners[i % 3];
      corners.head<3>().setZero();
      const Voigt strain = lost.u.transpose() * corners;
      corners.noalias() = lost.u * strain;
      for (Eigen::Index i = 0; i < 12; ++i) {
        const Index p = lost.places[static_cast<std::size_t>(i)];
        if (p != kNone) y[p] += corners[i];
      }
    }
  }

  /// u_ = (X f)_S of forces anywhere: with g = X0 f, X f = g + X D g.
  void apply_everywhere(const Eigen::VectorXd& f) {
    factor_->solve(f, everywhere_, work_);
    u_.resize(x_.rows());
    for (std::size_t i = 0; i < dofs_.size(); ++i) {
      u_[static_cast<Eigen::Index>(i)] = everywhere_[dofs_[i]];
    }
    if (lost_.empty()) return;
    multiply_lost(u_, lost_forces_);
    u_.noalias() += x_ * lost_forces_;
  }

  /// Adds the grips' forces that move u_G to the displacement (empty: 0); then what D u_S is.
  void hold(std::span<const double> displacement) {
    for (std::size_t g = 0; g < gripped_.size(); ++g) {
      grip_[static_cast<Eigen::Index>(g)] =
          (displacement.empty() ? 0.0 : displacement[g]) - u_[place_[gripped_[g]]];
    }
    if (!gripped_.empty()) grip_block_.solveInPlace(grip_);
    for (std::size_t g = 0; g < gripped_.size(); ++g) {
      u_ += grip_force(g) * x_.col(place_[gripped_[g]]);
    }
    for (std::size_t g = 0; g < gripped_.size(); ++g) {  // free of rounding
      u_[place_[gripped_[g]]] = displacement.empty() ? 0.0 : displacement[g];
    }
    multiply_lost(u_, lost_forces_);
  }

  /// The forces of grips and lost stiffness on the factor's body.
  void add_to(Eigen::VectorXd& f) const {
    for (std::size_t g = 0; g < gripped_.size(); ++g) f[gripped_[g]] += grip_force(g);
    for (std::size_t i = 0; i < dofs_.size(); ++i) {
      f[dofs_[i]] += lost_forces_[static_cast<Eigen::Index>(i)];
    }
  }

  void spread(Eigen::VectorXd& u) const {
    for (std::size_t i = 0; i < dofs_.size(); ++i) u[dofs_[i]] = u_[static_cast<Eigen::Index>(i)];
  }

  bool factor_grips() {
    const auto count = static_cast<Eigen::Index>(gripped_.size());
    grip_.setZero(count);
    if (count == 0) return true;
    grip_compliance_.resize(count, count);
    for (Eigen::Index j = 0; j < count; ++j) {
      for (Eigen::Index i = 0; i < count; ++i) {
        grip_compliance_(i, j) = x_(place_[gripped_[static_cast<std::size_t>(i)]],
                                    place_[gripped_[static_cast<std::size_t>(j)]]);
      }
    }
    grip_block_.compute(grip_compliance_);
    return grip_block_.info() == Eigen::Success && grip_block_.matrixLLT().allFinite();
  }

  /// Unknowns that an element destroyed by hand adds to S:
  /// X = X0 + X0 D X0 + X0 D X D X0, and X D X0 of it on the old ones.
  void grow(std::span<const Index> touched) {
    const auto before = static_cast<Eigen::Index>(dofs_.size());
    for (Index d : touched) {
      if (place_[d] == kNone) add_unknown(d);
    }
    const auto size = static_cast<Eigen::Index>(dofs_.size()), added = size - before;
    if (added == 0) return;
    Eigen::MatrixXd columns =
        factor_->inverse_block(dofs_, std::span(dofs_).subspan(static_cast<std::size_t>(before)));
    Eigen::MatrixXd forces(before, added);
    Eigen::VectorXd of_one;
    for (Eigen::Index j = 0; j < added; ++j) {
      multiply_lost(columns.col(j).head(before), of_one);
      forces.col(j) = of_one;
    }
    columns.topRows(before) += x_ * forces;
    columns.bottomRows(added) += forces.transpose() * columns.topRows(before);
    x_.conservativeResize(size, size);
    x_.rightCols(added) = columns;
    x_.bottomLeftCorner(added, before) = columns.topRows(before).transpose();
  }

  const DamagedBody& body_;
  std::shared_ptr<const fem::Factor> factor_;
  const fem::Factor* intact_;
  std::vector<Index> dofs_, place_;  // S, and where in it each unknown is
  std::span<const Index> gripped_;
  Eigen::MatrixXd x_;  // X_SS of the damaged body
  InverseUpdate update_;
  std::vector<LostElement> lost_;                                  // since factor_
  Eigen::MatrixXd grip_compliance_;                                // X_GG
  Eigen::LLT<Eigen::MatrixXd> grip_block_{Eigen::MatrixXd(0, 0)};  // of X_GG
  // Of the last solution, on S: displacement, forces of grips and of D.
  Load load_;
  Eigen::VectorXd u_, grip_, lost_forces_;
  Eigen::VectorXd right_side_, everywhere_;
  fem::SolveWork work_;
  int bases_ = 1;
};

}  // namespace

std::unique_ptr<InverseRoute> condensed_eager_route(const DamagedBody& body,
                                                    const IntactBody& intact,
                                                    std::span<const Index> dofs) {
  return std::make_unique<CondensedEagerRoute>(body, intact, dofs);
}

}  // namespace sunder::cpu_reference
