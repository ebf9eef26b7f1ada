// SPDX-License-Identifier: Apache-2.0
// Newton's method for bodies of pooled volume (method.md "Pooled volume"), whose patches' pressures
// are state of their own: after a step du they are p = U'(J) + U''/V b . du, and the next tangent
// is made with those. A step of finite size changes volumes at second order, which kappa makes a
// pressure that no equilibrium has: a tangent of it is far off, and may not be definite. No step is
// shortened, for the energy may rise on the way.
#pragma once

#include <vector>

#include "solver/finite_minimiser.hpp"

namespace sunder::solver {

struct PressureNewton {
  const FinitePotential& potential;
  const FiniteMinimiser& minimiser;
  const fem::TangentPattern& pattern;
};

/// From an evaluated state, with the pressures that patches had at rest, until the residual is no
/// more than `enough` of the forces that act. False: `most` steps do not do, two in a row have made
/// it worse, a tangent is not positive definite, or the potential is more than it was; the state is
/// then of no use.
[[nodiscard]] bool newton_with_pressures(const PressureNewton& by, const FiniteTarget& target,
                                         std::vector<double> pressure, double enough, int most,
                                         FiniteState& state, int& factors);

}  // namespace sunder::solver
