// SPDX-License-Identifier: Apache-2.0
// Saint Venant-Kirchhoff elasticity (Holzapfel 2000, 6.5): the linear law between the second
// Piola-Kirchhoff stress and the Green-Lagrange strain E = (F^T F - I)/2. W = mu |E|^2 +
// lambda/2 tr(E)^2, P = F (2 mu E + lambda tr(E) I).
// To compare with other codes: it softens under compression and holds nothing at F = 0.
#pragma once

#include "material/law.hpp"

namespace sunder {

extern const Law kSaintVenantKirchhoff;

}  // namespace sunder
