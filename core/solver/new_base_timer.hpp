// SPDX-License-Identifier: Apache-2.0
// What a frame pays for a base that it makes, or waits for.
#pragma once

#include <chrono>

#include "sunder/backend.hpp"

namespace sunder::solver {

/// Counts a base, with the time from here to the end of the scope.
class NewBaseTimer {
 public:
  explicit NewBaseTimer(NewBases& of) : of_(of) {}
  ~NewBaseTimer() {
    ++of_.count;
    of_.waited_ms += std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }
  NewBaseTimer(const NewBaseTimer&) = delete;
  NewBaseTimer& operator=(const NewBaseTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  NewBases& of_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace sunder::solver
