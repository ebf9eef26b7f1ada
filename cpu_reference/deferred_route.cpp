// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <thread>

#include "cpu_reference/background_rebase.hpp"
#include "cpu_reference/routes.hpp"
#include "engine/factor_base.hpp"
#include "engine/inverse_base.hpp"
#include "fem/assembly.hpp"

namespace sunder::cpu_reference {
namespace {

// Events between the start of a rebase and the frame that takes it: a factor takes as long as some
// 30 to 60 frames, whatever the size.
constexpr int kRebaseEvents = 64;

// An event that touches more new unknowns than this costs more than a new factor: a share of all
// within limits. Boards of 486 to 30,246 elements (bench_reconstruction, bench_engine).
constexpr double kLargestShare = 0.125, kSmallBody = 64;
constexpr double kLargestEvent = 600;

Based checked_factor(const DamagedBody& body, const Load& load, const fem::FactorWork& work) {
  Based based = based_on(body.problem(), body.scale(), work);
  check_base(based, body, load, [](Eigen::VectorXd&) {});
  return based;
}

class DeferredRoute final : public InverseRoute {
 public:
  DeferredRoute(const DamagedBody& body, const IntactBody& intact, bool dense, bool damage)
      : body_(body), dense_(dense), all_(static_cast<std::size_t>(body.problem().dof_count())) {
    std::iota(all_.begin(), all_.end(), 0);
    std::unique_ptr<engine::Base> base;
    if (dense) {
      base = std::make_unique<engine::InverseBase>(intact.factor);
    } else {
      base = std::make_unique<engine::FactorBase>(intact.factor);
    }
    based_.deferred = std::make_unique<engine::Deferred>(body.problem(), std::move(base), damage);
    set_threshold(intact.factor);
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
    if (4 * static_cast<double>(elements.size()) > largest_event() ||
        !based_.deferred->destroy(elements)) {
      rebase();
      return;
    }
    if (coming_) {
      coming_->follow(elements);
      if (coming_->followed() == kRebaseEvents) take_rebase();
    } else if (static_cast<std::size_t>(based_.deferred->rank()) > threshold_) {
      coming_ = std::make_unique<BackgroundRebase>(body_, load_, checked_factor);
    }
  }

  bool rebase() override {
    coming_.reset();
    saved_ms_ = saved_ms();
    reaper_ = {};
    based_ = {};  // frees the old base first
    based_ = based_on(body_.problem(), body_.scale());
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
  const BaseCheck& base_check() const override { return based_.check; }
  double waited_ms() const override { return waited_ms_; }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = based_.deferred->buffers();
    if (based_.factor) {
      plan.push_back({"damaged factor (sparse Cholesky)", based_.factor->bytes()});
    }
    return plan;
  }

 private:
  double largest_event() const {
    return std::clamp(kLargestShare * body_.problem().dof_count(), kSmallBody, kLargestEvent);
  }

  void take_rebase() {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    Based next = coming_->take();
    waited_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    coming_.reset();
    if (!next.deferred) return;  // what there is still holds; the next event tries again
    saved_ms_ = saved_ms();
    std::swap(based_, next);
    rebased();
    // Giving some megabytes back takes as long as a frame.
    reaper_ = std::jthread([old = std::move(next)]() mutable { old = {}; });
  }

  void rebased() {
    ++bases_;
    set_threshold(*based_.factor);
  }

  /// The small matrices cost a frame some 4 T^2 values, a factor's solution its entries: past a
  /// third of them a new base is worth it.
  void set_threshold(const fem::Factor& factor) {
    const double share = 0.3 * std::sqrt(static_cast<double>(factor.entries()));
    threshold_ = body_.problem().gripped_dofs().size() +
                 static_cast<std::size_t>(std::clamp(share, 128.0, 512.0));
  }

  const DamagedBody& body_;
  bool dense_;              // the first base is an inverse
  std::vector<Index> all_;  // every unknown: the loads of a residual
  Load load_;               // of the last solution
  Based based_;
  std::jthread reaper_;  // frees the base before this one
  std::unique_ptr<BackgroundRebase> coming_;
  std::size_t threshold_ = 0;
  int bases_ = 1;
  double waited_ms_ = 0;
  double saved_ms_ = 0;  // by the bases before this one
  double enough_ = 0;
};

}  // namespace

std::unique_ptr<InverseRoute> deferred_route(const DamagedBody& body, const IntactBody& intact,
                                             bool dense, bool damage) {
  return std::make_unique<DeferredRoute>(body, intact, dense, damage);
}

}  // namespace sunder::cpu_reference
