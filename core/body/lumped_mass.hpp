// SPDX-License-Identifier: Apache-2.0
// Masses at the nodes: a quarter of each element's at each of its corners.
#pragma once

#include <span>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::fem {

/// Per node [t]; `density` of each of Mesh::volumes [t/mm^3]. Destroyed elements keep their mass. A
/// node of no element gets none.
[[nodiscard]] std::vector<double> lumped_masses(const Problem& problem,
                                                std::span<const double> density);
/// By the materials' densities, which are there.
[[nodiscard]] std::vector<double> lumped_masses(const Problem& problem);

}  // namespace sunder::fem
