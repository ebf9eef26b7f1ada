// SPDX-License-Identifier: Apache-2.0
// Near-tip fields of a crack in an elastic plane (Williams 1957) with unit stress intensity: the
// auxiliary states of the interaction integral. Tip frame: x1 forward along the crack, x2 to its
// left, x3 out of the plane; lengths in mm, stress in MPa.
#pragma once

#include <array>

#include "sunder/types.hpp"

namespace sunder::fracture {

/// What holds the body along x3: c = 0 plane stress, c = 1 plane strain, in between
/// s33 = c nu (s11 + s22). E' = E / (1 - c nu^2) turns energy release into K: G = K^2 / E'.
struct TipMaterial {
  double young = 0, poisson = 0;
  double constraint = 0;  ///< c

  [[nodiscard]] double shear() const { return young / (2 * (1 + poisson)); }
  [[nodiscard]] double effective_young() const {
    return young / (1 - constraint * poisson * poisson);
  }
  /// Kolosov's constant: (3 - nu)/(1 + nu) in plane stress, 3 - 4 nu in plane strain.
  [[nodiscard]] double kolosov() const;
};

enum Mode { kModeI, kModeII, kModeIII, kModes };

struct AuxiliaryState {
  Mat3 stress;  ///< [MPa]
  Vec3 slope;   ///< du/dx1
};

/// The states of K_I = 1, K_II = 1, K_III = 1 [MPa sqrt(mm)] at x (not the tip). `side` of the
/// crack on which x lies, +1 left or -1 right, 0: by its own x2. It tells apart the two faces, and
/// where a bent crack crosses the line behind its tip it continues the field beyond 180 degrees.
[[nodiscard]] std::array<AuxiliaryState, kModes> auxiliary_states(const Vec2& x, int side,
                                                                  const TipMaterial& material);

/// The states whose interaction with the field of a crack that ends a little behind the tip is its
/// intensity times that distance: those of Williams' next term but one, displacement ~ r^(3/2),
/// which see nothing of a crack's field that ends at the tip.
[[nodiscard]] std::array<AuxiliaryState, kModes> shift_states(const Vec2& x, int side,
                                                              const TipMaterial& material);

}  // namespace sunder::fracture
