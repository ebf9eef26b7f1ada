// SPDX-License-Identifier: Apache-2.0
// A new base computed while frames go on: a thread factors the body as it was when it started and
// follows every event since. Taken at a fixed event, so what it returns depends on the events
// alone, never on how long anything took.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "cpu_reference/routes.hpp"

namespace sunder::cpu_reference {

/// A base with the damage laid over it.
struct Based {
  BaseCheck check;
  std::unique_ptr<fem::Factor> factor;  // what the base reads; empty: it is the intact one
  std::unique_ptr<engine::Deferred> deferred;
};

class BackgroundRebase {
 public:
  /// Starts. `body` as it is now; `load`: likely that of the frame that takes the base.
  BackgroundRebase(const DamagedBody& body, const Load& load);
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
  void check(Based& based) const;
  [[nodiscard]] bool next(std::vector<Index>& elements);

  DamagedBody body_;
  Load load_;
  Based result_;
  int followed_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Index> elements_;    // of events not yet followed, guarded by mutex_
  std::vector<std::size_t> ends_;  // of each of them
  bool closed_ = false;            // no event will come
  std::thread thread_;             // last: it uses all above
};

/// The factor of a body and an empty damage over it.
[[nodiscard]] Based based_on(const Problem& problem, std::span<const double> scale);

}  // namespace sunder::cpu_reference
