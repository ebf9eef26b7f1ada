// SPDX-License-Identifier: Apache-2.0
// Element stress.
#pragma once

#include <span>
#include <vector>

#include "sunder/backend.hpp"

namespace sunder::cpu_reference {

/// stress[e] = a_e D B u from the displacement at all nodes (3 * nodes); a_e = scale[e].
void element_stress(const Problem& problem, std::span<const double> scale,
                    std::span<const double> u, std::span<Voigt> stress);

}  // namespace sunder::cpu_reference
