// SPDX-License-Identifier: Apache-2.0
#include <numeric>

#include "cpu_reference/routes.hpp"
#include "fem/assembly.hpp"

namespace sunder::cpu_reference {
namespace {

/// Deferred update over X_SS. The number of unknowns it can touch is bounded by S, so that no
/// growing damage asks for a new base; only rounding can.
class CondensedRoute final : public InverseRoute {
 public:
  CondensedRoute(const DamagedBody& body, const IntactBody& intact, std::span<const Index> dofs,
                 bool damage)
      : body_(body), dofs_(dofs.begin(), dofs.end()), all_(dof_count()), damage_(damage) {
    std::iota(all_.begin(), all_.end(), 0);
    // Without an owner: the intact body outlives the route.
    lay_over({std::shared_ptr<void>(), &intact.factor});
  }

  Applied solve(const Load& load, const Eigen::VectorXd&, Eigen::VectorXd& u) override {
    deferred_->solve({load.force_dofs, load.forces}, load.displacements, u, enough_);
    return {};
  }

  Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& u) override {
    deferred_->solve({all_, {r.data(), static_cast<std::size_t>(r.size())}}, {}, u);
    complete(u);
    return {};
  }

  void complete(Eigen::VectorXd& u) override {
    base_->equilibrium(whole_);
    solve_whole(whole_, right_side_, everywhere_);
    for (Index d : base_->dofs()) everywhere_[d] = u[d];
    u.swap(everywhere_);
  }

  bool equilibrium(engine::Equilibrium& of) const override {
    base_->equilibrium(of);
    return true;
  }

  void destroy(std::span<const Index> elements) override {
    if (!deferred_->destroy(elements)) rebase();
  }

  bool rebase() override {
    lay_over(std::make_shared<fem::Factor>(body_.problem(), body_.scale()));
    rebased_ = true;
    ++bases_;
    return true;
  }

  const engine::Deferred* deferred() const override { return deferred_.get(); }
  void set_enough(double energy) override { enough_ = energy; }
  int bases() const override { return bases_; }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = deferred_->buffers();
    if (rebased_) plan.push_back({"damaged factor (sparse Cholesky)", factor_->bytes()});
    return plan;
  }

 private:
  [[nodiscard]] std::size_t dof_count() const {
    return static_cast<std::size_t>(body_.problem().dof_count());
  }

  void lay_over(std::shared_ptr<const fem::Factor> factor) {
    auto base = std::make_unique<engine::CondensedBase>(factor, dofs_);
    base_ = base.get();
    factor_ = std::move(factor);
    deferred_ = std::make_unique<engine::Deferred>(body_.problem(), std::move(base), damage_);
  }

  const DamagedBody& body_;
  std::vector<Index> dofs_, all_;  // S; every unknown: the loads of a residual
  std::shared_ptr<const fem::Factor> factor_;
  std::unique_ptr<engine::Deferred> deferred_;
  engine::CondensedBase* base_ = nullptr;  // what deferred_ holds
  engine::Equilibrium whole_;
  Eigen::VectorXd right_side_, everywhere_;
  double enough_ = 0;
  int bases_ = 1;
  bool rebased_ = false, damage_;
};

}  // namespace

void solve_whole(const engine::Equilibrium& of, Eigen::VectorXd& right_side, Eigen::VectorXd& u) {
  right_side.setZero(of.factor->cholesky().size());
  for (std::size_t i = 0; i < of.dofs.size(); ++i) right_side[of.dofs[i]] += of.forces[i];
  fem::SolveWork work;
  of.factor->solve(right_side, u, work);
}

std::unique_ptr<InverseRoute> condensed_route(const DamagedBody& body, const IntactBody& intact,
                                              std::span<const Index> dofs, bool damage) {
  return std::make_unique<CondensedRoute>(body, intact, dofs, damage);
}

}  // namespace sunder::cpu_reference
