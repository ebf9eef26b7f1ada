// SPDX-License-Identifier: Apache-2.0
// What a body's materials oppose to cracks that grow (method.md "Toughness"): K_c as given, or by
// G_c = K_c^2/E' with the E' that field K takes at the tip; of a tissue with fibres by the
// direction of growth (method.md "Toughness by direction").
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/tip_resistance.hpp"
#include "sunder/problem.hpp"

namespace sunder::fracture {

/// What a material says: K_c [MPa sqrt(mm)], or G_c [N/mm]; 0: not given.
struct GivenToughness {
  double intensity = 0, energy = 0;
  /// K_c^2 [MPa^2 mm]; 0: neither is given.
  [[nodiscard]] double squared(double young) const {
    return intensity > 0 ? intensity * intensity : energy * young;
  }
};

/// K_c of elements ahead of one tip.
struct ToughnessView {
  std::span<const GivenToughness> along;   ///< per element; empty: none has any
  std::span<const GivenToughness> across;  ///< where fibres guide cracks, likewise
  std::span<const Vec3> fibres;            ///< unit; likewise
  double young = 0;                        ///< E' at the tip [MPa], read where a G_c is given
  Vec3 normal = Vec3::Zero();              ///< unit, of the crack as it would grow

  /// K_c of an element; 0: it has none, Eq. 1 decides.
  [[nodiscard]] double of(Index e) const;
};

class Toughness {
 public:
  /// Both must outlive it.
  Toughness(const Problem& problem, const Board& board);

  /// Whether a material that elements have says anything.
  [[nodiscard]] bool any() const { return any_; }
  /// Whether one says it as an energy, so that E' is needed.
  [[nodiscard]] bool by_energy() const { return by_energy_; }
  /// Whether one says it by direction.
  [[nodiscard]] bool by_direction() const { return !across_.empty(); }
  /// With E' at the tip [MPa], read where by_energy(), for growth along a direction of the plane.
  [[nodiscard]] ToughnessView view(double young, const Vec2& direction) const;
  /// Mean by volume over live elements within 1.5 h of a place; none: no fibres guide cracks there.
  /// Allocates nothing.
  [[nodiscard]] std::optional<TipResistance> around(const Vec2& place, double young,
                                                    std::span<const std::uint8_t> destroyed) const;

 private:
  const Problem& problem_;
  const Board& board_;
  std::vector<GivenToughness> along_, across_;  // shape (elements); the latter empty: by none
  std::vector<Vec3> fibres_;                    // where across_ is there
  bool any_ = false, by_energy_ = false;
  mutable std::vector<Index> near_;  // with room for the fullest place
};

}  // namespace sunder::fracture
