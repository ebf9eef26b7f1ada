// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sunder/problem.hpp"

namespace sunder {

/// Whether the intact bodies of two problems have the same stiffness by every bit: mesh, elasticity
/// by element, unknowns and the springs of bodies that only grips hold. Loads, strengths and what
/// is destroyed are not looked at.
[[nodiscard]] bool same_stiffness(const Problem& a, const Problem& b);

}  // namespace sunder
