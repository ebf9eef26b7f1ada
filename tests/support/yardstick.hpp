// SPDX-License-Identifier: Apache-2.0
// What a body comes to by the yardstick (cpu_reference/plain).
#pragma once

#include <gtest/gtest.h>

#include <utility>

#include "cpu_reference/plain/plain.hpp"
#include "support/loads.hpp"

namespace sunder::test {

/// What the yardstick may still correct of itself: a tenth of the finest promise (accuracy.hpp).
inline constexpr double kYardstick = 1e-10;

/// Under nodal forces (3 * nodes; those at supports are dropped) and the grips' displacements.
inline plain::Solution yardstick(const Problem& problem, std::span<const std::uint8_t> destroyed,
                                 std::span<const double> force,
                                 std::vector<double> displacements = {}) {
  plain::Body body(problem, destroyed);
  plain::Solution solution = body.solve(load_of(problem, force, std::move(displacements)));
  EXPECT_LE(solution.error, kYardstick);
  return solution;
}

}  // namespace sunder::test
