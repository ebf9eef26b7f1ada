// SPDX-License-Identifier: Apache-2.0
// Compressible neo-Hookean elasticity (Bonet and Wood 2008, 6.4.3), J = det F:
// W = mu/2 (|F|^2 - 3) - mu ln J + lambda/2 (ln J)^2, P = mu (F - F^-T) + lambda ln J F^-T.
// There is no state with J <= 0: its energy is infinite, and no line search goes there.
//
// Its split into shape and volume: W_s = mu/2 (|F|^2 - 3 J^(2/3)), which is polyconvex and not
// below 0, and U = 3/2 mu (J^(2/3) - 1) - mu ln J + lambda/2 (ln J)^2.
#pragma once

#include "material/law.hpp"

namespace sunder {

extern const Law kNeoHookean;

}  // namespace sunder
