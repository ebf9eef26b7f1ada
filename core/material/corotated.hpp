// SPDX-License-Identifier: Apache-2.0
// Corotated linear elasticity: the linear law in a frame that turns with the element (Mueller and
// Gross 2004). With F = R S, W = mu |S - I|^2 + lambda/2 tr(S - I)^2 and
// P = R (2 mu (S - I) + lambda tr(S - I) I).
//
// Inverted elements are pushed back by a finite stress. Across s1 + s2 = 0 the nearest rotation,
// and with it P, jumps: W has a ridge there, and the tangent's eigenvalue of that twist goes to
// infinity, mostly downwards.
#pragma once

#include "material/law.hpp"

namespace sunder {

extern const Law kCorotated;

}  // namespace sunder
