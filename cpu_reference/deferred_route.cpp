// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <optional>

#include "cpu_reference/cost_model.hpp"
#include "cpu_reference/routes.hpp"
#include "engine/background_rebase.hpp"
#include "engine/factor_base.hpp"
#include "engine/inverse_base.hpp"
#include "engine/load_room.hpp"

namespace sunder::cpu_reference {
namespace {

// Columns that a fracture of one element adds to the damage, along a tear.
constexpr double kColumns = 1.75;
constexpr double kFewestColumns = 64;
// Columns beyond those that a base is expected to serve, in fractures of several elements.
constexpr Index kSpare = 64;

class DeferredRoute final : public InverseRoute {
 public:
  DeferredRoute(const DamagedBody& body, IntactBody& intact, bool dense,
                std::chrono::milliseconds rest)
      : body_(body),
        dense_(dense),
        all_(static_cast<std::size_t>(body.problem().dof_count())),
        stiffness_(std::move(intact.stiffness)) {
    std::iota(all_.begin(), all_.end(), 0);
    engine::reserve(load_, body.problem());
    std::unique_ptr<engine::Base> base;
    if (dense) {
      base = std::make_unique<engine::InverseBase>(intact.factor);
    } else {
      base = std::make_unique<engine::FactorBase>(intact.factor);
    }
    const bool damage = stiffness_ != nullptr;
    if (!damage) {
      based_.deferred = std::make_unique<engine::Deferred>(body.problem(), std::move(base), false);
      return;
    }
    const int frames = frames_of_a_factor(intact.factor.cholesky(), body.scale().size());
    // As many as have followed a base when it is taken: where frames tear without a pause, the next
    // one begins at once.
    rebased_at_ = body.problem().gripped_dofs().size() +
                  static_cast<std::size_t>(std::max(kColumns * frames, kFewestColumns));
    threshold_ = rebased_at_;
    const Index followed = static_cast<Index>(kColumns * frames) + kSpare;
    columns_ = static_cast<Index>(rebased_at_) + followed;
    // The factor that takes the inverse's place solves backward for as much as so many columns.
    if (dense) threshold_ = std::max(threshold_, intact.factor.entries() / all_.size());
    based_.deferred = std::make_unique<engine::Deferred>(body.problem(), std::move(base), true,
                                                         static_cast<Index>(threshold_) + followed);
    coming_.emplace(body, frames, rest);
  }

  Applied solve(const Load& load, const Eigen::VectorXd&, Eigen::VectorXd& u) override {
    load_ = load;
    based_.deferred->solve({load.force_dofs, load.forces}, load.displacements, u, enough_);
    return {};
  }

  Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& u) override {
    based_.deferred->correct({all_, {r.data(), static_cast<std::size_t>(r.size())}}, u);
    return {};
  }

  void destroy(std::span<const Index> elements) override {
    if (coming_->due()) take_base();
    coming_->follow(elements);
    if (takes_new_factor(all_.size(), elements.size()) || !based_.deferred->destroy(elements)) {
      rebase();
    } else if (!coming_->making() &&
               static_cast<std::size_t>(based_.deferred->rank()) > threshold_) {
      coming_->start(
          load_, [this](const DamagedBody& body, const Load& load, const fem::FactorWork& work) {
            engine::Based based = based_on(body, work);
            engine::check_base(based, body, load, [](Eigen::VectorXd&) {});
            return based;
          });
    }
  }

  bool rebase() override {
    if (!coming_) return false;
    coming_->give_up();
    saved_ms_ = saved_ms();
    based_ = {};  // frees the old base first
    based_ = based_on(body_, {});
    rebased();
    return true;
  }

  // A column of the dense inverse is at hand without.
  bool prepares() const override { return !dense_ || based_.factor; }
  void prepare(std::span<const Index> elements) override { based_.deferred->prepare(elements); }
  double saved_ms() const override { return saved_ms_ + based_.deferred->saved_ms(); }

  const engine::Deferred* deferred() const override { return based_.deferred.get(); }
  void set_enough(double energy) override { enough_ = energy; }
  int bases() const override { return bases_; }
  const engine::BaseCheck& base_check() const override { return based_.check; }
  double waited_ms() const override { return coming_ ? coming_->waited_ms() : 0; }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = based_.deferred->buffers();
    if (based_.factor) {
      plan.push_back({"damaged factor (sparse Cholesky)", based_.factor->bytes()});
    }
    if (stiffness_) plan.push_back({"stiffness in the factor's order", stiffness_->bytes()});
    return plan;
  }

 private:
  void take_base() {
    const double saved = saved_ms();
    if (!coming_->take(based_)) return;  // what there is still holds; the next event tries again
    saved_ms_ = saved;
    rebased();
  }

  void rebased() {
    threshold_ = rebased_at_;
    ++bases_;
  }

  /// A factor of the body and an empty damage over it.
  engine::Based based_on(const DamagedBody& body, const fem::FactorWork& work) {
    stiffness_->follow(body.scale());
    engine::Based based;
    based.factor = std::make_shared<const fem::Factor>(stiffness_->factor(work));
    based.deferred = std::make_unique<engine::Deferred>(
        body.problem(), std::make_unique<engine::FactorBase>(*based.factor), true, columns_);
    // Room for predictions too: the frame that takes the base is to allocate nothing.
    if (body.problem().scene().solver.prepare) based.deferred->prepare({});
    return based;
  }

  const DamagedBody& body_;
  bool dense_;              // the first base is an inverse
  std::vector<Index> all_;  // every unknown: the loads of a residual
  Load load_;               // of the last solution
  engine::Based based_;
  // Columns of the damage at which a new base begins: now, and over a factor.
  std::size_t threshold_ = 0, rebased_at_ = 0;
  Index columns_ = 0;  // that a base over a factor is expected to serve
  int bases_ = 1;
  double saved_ms_ = 0;  // by the bases before this one
  double enough_ = 0;
  std::unique_ptr<fem::OrderedStiffness> stiffness_;  // of whoever makes a base
  std::optional<engine::BackgroundRebase> coming_;    // last: its thread uses what is above
};

}  // namespace

std::unique_ptr<InverseRoute> deferred_route(const DamagedBody& body, IntactBody& intact,
                                             bool dense, std::chrono::milliseconds rest) {
  return std::make_unique<DeferredRoute>(body, intact, dense, rest);
}

}  // namespace sunder::cpu_reference
