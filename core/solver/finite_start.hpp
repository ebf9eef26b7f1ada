// SPDX-License-Identifier: Apache-2.0
// Where to begin to look for the next equilibrium: candidates that follow a load's change better
// than the last state does.
#pragma once

#include <span>
#include <vector>

#include "solver/finite_potential.hpp"

namespace sunder::solver {

/// `u` moved as a whole by the rigid motion nearest to the grips' (Kabsch 1976), where no support
/// holds anything; else, or where that turns nothing, empty.
[[nodiscard]] std::vector<double> follow_grips_rigidly(const Problem& problem,
                                                       std::span<const double> u,
                                                       std::span<const double> grips);

/// How many times the change from `before` to `now` leads from `now` to `next`; 0: they are not
/// alike.
[[nodiscard]] double continuation(const FiniteTarget& before, const FiniteTarget& now,
                                  const FiniteTarget& next);

}  // namespace sunder::solver
