// SPDX-License-Identifier: Apache-2.0
#include "fracture/toughness.hpp"

#include <cmath>

namespace sunder::fracture {

double ToughnessView::of(Index e) const {
  if (intensity.empty()) return 0;
  if (intensity[e] > 0) return intensity[e];
  return energy[e] > 0 ? std::sqrt(energy[e] * young) : 0;
}

Toughness::Toughness(const Problem& problem)
    : intensity_(problem.mesh().tets.size(), 0), energy_(problem.mesh().tets.size(), 0) {
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Material& material = problem.material(e);
    intensity_[e] = material.toughness.value_or(0.0);
    energy_[e] = material.energy.value_or(0.0);
    any_ = any_ || material.tough();
    by_energy_ = by_energy_ || material.energy;
  }
}

ToughnessView Toughness::view(double young) const {
  if (!any_) return {};
  return {intensity_, energy_, young};
}

}  // namespace sunder::fracture
