// SPDX-License-Identifier: Apache-2.0
// A new base computed while frames go on: a thread makes it of the body as it was when it started
// and follows every event since. Taken at a fixed event, so what it returns depends on the events
// alone, never on how long anything took.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "cpu_reference/routes.hpp"

namespace sunder::cpu_reference {

/// A base with the damage laid over it.
struct Based {
  BaseCheck check;
  std::shared_ptr<const fem::Factor> factor;  // what the base reads; empty: it is the intact one
  std::unique_ptr<engine::Deferred> deferred;
  engine::CondensedBase* condensed = nullptr;  // what `deferred` holds, where it is one
};

/// Makes a base of a body with no damage over it yet, and checks it by a load; `work` is for a
/// factor on the way.
using MakeBase = std::function<Based(const DamagedBody&, const Load&, const fem::FactorWork&)>;

class BackgroundRebase {
 public:
  /// Starts. `body` as it is now; `load`: likely that of the frame that takes the base.
  BackgroundRebase(const DamagedBody& body, const Load& load, MakeBase make);
  /// Gives up a factor that is being made.
  ~BackgroundRebase();
  BackgroundRebase(const BackgroundRebase&) = delete;
  BackgroundRebase& operator=(const BackgroundRebase&) = delete;

  /// Tells it of an event.
  void follow(std::span<const Index> elements);
  [[nodiscard]] int followed() const { return followed_; }
  /// Waits until every event is followed. Without `deferred`: not positive definite in double
  /// precision.
  [[nodiscard]] Based take();

 private:
  void run();
  [[nodiscard]] bool next(std::vector<Index>& elements);

  DamagedBody body_;
  Load load_;
  MakeBase make_;
  Based result_;
  int followed_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Index> elements_;    // of events not yet followed, guarded by mutex_
  std::vector<std::size_t> ends_;  // of each of them
  bool closed_ = false;            // no event will come
  std::atomic<bool> unwanted_{false};
  std::thread thread_;  // last: it uses all above
};

/// The factor of a body and an empty damage over it.
[[nodiscard]] Based based_on(const Problem& problem, std::span<const double> scale,
                             const fem::FactorWork& work = {});

/// A full check of a new base (frame_check.hpp). It solves for the load once more at the end: the
/// frame that takes the base finds its load known, and all memory touched. `complete` fills what a
/// solution leaves out.
void check_base(Based& based, const DamagedBody& body, const Load& load,
                const std::function<void(Eigen::VectorXd&)>& complete);

}  // namespace sunder::cpu_reference
