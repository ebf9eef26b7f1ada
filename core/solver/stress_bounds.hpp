// SPDX-License-Identifier: Apache-2.0
// Bounds on the stress that an energy or the rounding of a displacement stands for: what the checks
// of a frame reckon with on every device.
#pragma once

#include "sunder/problem.hpp"

namespace sunder::solver {

/// Bound on |sigma| / sqrt(u^T K u) over all elements and displacements [MPa / sqrt(N mm)].
[[nodiscard]] double largest_stress_of_energy(const Problem& problem);

/// A bound on the stress that rounding displacements to fp64 costs an element [MPa], where the
/// largest is `largest_u` [mm]: half an ulp of it times the largest |D| |B|.
[[nodiscard]] double stress_of_rounding(const Problem& problem, double largest_u);

}  // namespace sunder::solver
