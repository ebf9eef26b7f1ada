// SPDX-License-Identifier: Apache-2.0
// K u of eight displacements at once: what an element is, is read once for all of them.
#pragma once

#include <span>

#include "sunder/problem.hpp"

namespace sunder::fem {

inline constexpr int kProductsAtOnce = 8;

/// y = K u as apply_stiffness() has it, of bodies without pooled volume. `u` and `y`: for each of
/// the 3 * node_count entries the eight, one beside the other.
void apply_stiffness_to_eight(const Problem& problem, std::span<const double> scale,
                              std::span<const double> u, std::span<double> y);

}  // namespace sunder::fem
