// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "sunder/instrument_forces.hpp"

namespace sunder::test {

/// Range of the sum of |force| over answers or frames.
struct Pulls {
  long count = 0;
  long bad = 0;  ///< values that are not finite
  double least = 0, most = 0;

  void add(std::span<const double> forces) {
    double pull = 0;
    for (double f : forces) {
      if (!std::isfinite(f)) ++bad;
      pull += std::abs(f);
    }
    least = count == 0 ? pull : std::min(least, pull);
    most = std::max(most, pull);
    ++count;
  }
};

/// Asks for the grips' forces from a thread of its own until `end`.
class HapticReader {
 public:
  HapticReader(InstrumentForces& block, std::vector<double> held)
      : block_(block), held_(std::move(held)), thread_([this] { read(); }) {}
  ~HapticReader() { stop(); }
  HapticReader(const HapticReader&) = delete;
  HapticReader& operator=(const HapticReader&) = delete;

  /// What it was answered; waits for a first answer.
  Pulls end() {
    while (!answered_) std::this_thread::yield();
    stop();
    return pulls_;
  }

 private:
  void read() {
    std::vector<double> forces(held_.size());
    while (!done_) {
      if (!block_.forces(held_, forces)) continue;
      pulls_.add(forces);
      answered_ = true;
      std::this_thread::yield();
    }
  }
  void stop() {
    done_ = true;
    if (thread_.joinable()) thread_.join();
  }

  InstrumentForces& block_;
  std::vector<double> held_;
  Pulls pulls_;
  std::atomic<bool> done_{false}, answered_{false};
  std::thread thread_;  // last: it reads what is above
};

}  // namespace sunder::test
