// SPDX-License-Identifier: Apache-2.0
// Whether a triangle passes through a tetrahedron.
#pragma once

#include <array>

#include "sunder/types.hpp"

namespace sunder::fem {

/// Whether the triangle meets the tetrahedron's inside; touching it from outside does not count.
/// Both in mm, the tetrahedron in any orientation. False where one of them is not finite, or the
/// triangle has no area.
[[nodiscard]] bool crosses(const std::array<Vec3, 3>& triangle, const std::array<Vec3, 4>& tet);

}  // namespace sunder::fem
