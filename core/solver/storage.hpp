// SPDX-License-Identifier: Apache-2.0
// In what precision a device stores the inverse and element stress.
#pragma once

#include <string>

#include "sunder/problem.hpp"

namespace sunder::solver {

struct Storage {
  bool fp64 = true;
  std::string why;      ///< empty: the device has no choice
  std::string warning;  ///< what was asked for may cost more than it seems; empty: nothing
};

/// On a device that has fp32 with sums in fp64 or, without `float64`, on the host.
[[nodiscard]] Storage choose_storage(const Problem& problem, bool float64);

/// "0.0001".
[[nodiscard]] std::string number(double value);

}  // namespace sunder::solver
