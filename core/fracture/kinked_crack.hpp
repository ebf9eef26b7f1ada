// SPDX-License-Identifier: Apache-2.0
// A crack that turns: stress intensity at the end of an infinitesimal kink, and the turn that a
// tissue with fibres prefers (method.md "Toughness by direction").
#pragma once

#include <numbers>
#include <optional>

#include "fracture/tip_resistance.hpp"

namespace sunder::fracture {

/// The largest turn that is looked at [rad]: as far as the series holds.
inline constexpr double kLargestKink = 80 * std::numbers::pi / 180;

struct KinkIntensity {
  double k_1 = 0, k_2 = 0;  ///< at the kink's end [MPa sqrt(mm)]
  [[nodiscard]] double squared() const { return k_1 * k_1 + k_2 * k_2; }  ///< G(theta) E'
};

/// At the end of a kink by theta [rad], counter-clockwise, from K_I and K_II before it (Amestoy and
/// Leblond, Int. J. Solids Struct. 29, 1992, Table 1). K_I < 0 counts 0.
[[nodiscard]] KinkIntensity kinked(double k_1, double k_2, double theta);

struct Turn {
  double theta = 0;      ///< [rad] from the crack's direction
  double intensity = 0;  ///< sqrt(G(theta) E') [MPa sqrt(mm)]
};

/// The turn with the largest G(theta)/G_c(theta) of those that open the kink; of equal ones the
/// smallest, then the clockwise one. `direction`: the crack's. None: nothing opens it.
[[nodiscard]] std::optional<Turn> easiest_turn(double k_1, double k_2, const Vec2& direction,
                                               const TipResistance& resistance);

}  // namespace sunder::fracture
