// SPDX-License-Identifier: Apache-2.0
// Two checks, each of loads on some unknowns. A question on the side
// (which instrument broke an element: attribution.hpp) has a load of its own; what is known of the
// frames' load must not depend on whether somebody asked.
#pragma once

#include <array>

#include "sunder/backend.hpp"

namespace sunder::solver {

/// Check: FrameCheck or EnergyCheck.
template <class Check>
class RecentChecks {
 public:
  template <class... Of>
  explicit RecentChecks(const Of&... of) : checks_{Check(of...), Check(of...)} {}

  /// The check that takes the load's unknowns; else the one used longest ago.
  [[nodiscard]] Check& of(const Load& load) {
    if (checks_[last_].takes(load)) return checks_[last_];
    last_ = 1 - last_;
    return checks_[last_];
  }
  [[nodiscard]] std::array<Check, 2>& all() { return checks_; }

 private:
  std::array<Check, 2> checks_;
  std::size_t last_ = 0;
};

}  // namespace sunder::solver
