// SPDX-License-Identifier: Apache-2.0
// What a body's materials oppose to cracks that grow (method.md "Toughness"): K_c as given, or by
// G_c = K_c^2/E' with the E' that field K takes at the tip.
#pragma once

#include <span>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::fracture {

/// K_c of elements ahead of one tip.
struct ToughnessView {
  std::span<const double> intensity;  ///< K_c [MPa sqrt(mm)] per element, 0: not given
  std::span<const double> energy;     ///< G_c [N/mm] likewise; both empty: none has any
  double young = 0;                   ///< E' at the tip [MPa], read where a G_c is given

  /// K_c of an element; 0: it has none, Eq. 1 decides.
  [[nodiscard]] double of(Index e) const;
};

class Toughness {
 public:
  explicit Toughness(const Problem& problem);

  /// Whether a material that elements have says anything.
  [[nodiscard]] bool any() const { return any_; }
  /// Whether one says it as an energy, so that E' is needed.
  [[nodiscard]] bool by_energy() const { return by_energy_; }
  /// With E' at the tip [MPa], read where by_energy().
  [[nodiscard]] ToughnessView view(double young) const;

 private:
  std::vector<double> intensity_, energy_;  // shape (elements)
  bool any_ = false, by_energy_ = false;
};

}  // namespace sunder::fracture
