// SPDX-License-Identifier: Apache-2.0
// Loops whose passes several threads share: what takes milliseconds and more, where a thread is
// started for it.
#pragma once

#include <atomic>

#include "linear_algebra/workers.hpp"
#include "sunder/types.hpp"

namespace sunder::linear_algebra {

/// As many as there are processors.
[[nodiscard]] int machine_threads();
/// Half of them, at least one.
[[nodiscard]] int background_threads();

class SharedLoop {
 public:
  /// `threads` at most, the caller's among them; once `stop` is true no pass begins any more.
  explicit SharedLoop(int threads, const std::atomic<bool>* stop = nullptr)
      : workers_(threads), stop_(stop) {}

  /// Threads that take part: worker numbers are 0 ... count() - 1.
  [[nodiscard]] int count() const { return workers_.count(); }

  /// body(pass, worker) for each pass 0 ... passes - 1, those of one worker one after the other.
  /// What a pass throws ends the loop and is thrown here. False: it was stopped.
  template <class Body>
  [[nodiscard]] bool run(Index passes, Body&& body) {
    std::atomic<Index> next{0};
    std::atomic<bool> ends{false};
    workers_.run([&](int worker) {
      try {
        while (!ends && !stopped()) {
          const Index pass = next.fetch_add(1, std::memory_order_relaxed);
          if (pass >= passes) return;
          body(pass, worker);
        }
      } catch (...) {
        ends = true;
        throw;
      }
    });
    return !stopped();
  }

 private:
  [[nodiscard]] bool stopped() const { return stop_ && *stop_; }

  Workers workers_;
  const std::atomic<bool>* stop_;
};

}  // namespace sunder::linear_algebra
