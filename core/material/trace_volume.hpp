// SPDX-License-Identifier: Apache-2.0
// The volume part of laws whose energy is mu |E|^2 + lambda/2 (tr E)^2 of some strain E
// (VolumeSplit): J = 1 + tr E, U = kappa/2 (J - 1)^2, and W_s is the law itself without its
// pressure.
#pragma once

#include "material/law.hpp"
#include "material/linear.hpp"

namespace sunder {

inline VolumeSplit::Volume trace_volume(const SmallStrain& law, double j) {
  const double kappa = law.triple_bulk / 3, dilation = j - 1;
  return {kappa / 2 * dilation * dilation, kappa * dilation, kappa};
}

/// `kTangent`: of W + p J.
template <FibreTheory kTheory, auto kEnergy, auto kStress, auto kTangent, auto kRatio,
          auto kRatioSlope>
constexpr VolumeSplit trace_split() {
  constexpr auto energy = [](const SmallStrain& law, const Mat3& f) {
    return kEnergy(without_pressure(law), f);
  };
  constexpr auto stress = [](const SmallStrain& law, const Mat3& f) {
    return kStress(without_pressure(law), f);
  };
  constexpr auto tangent = [](const SmallStrain& law, const Mat3& f, double pressure) {
    return kTangent(without_pressure(law), f, pressure);
  };
  return split_with_fibres<kTheory, energy, stress, tangent, kRatio, kRatioSlope, trace_volume>();
}

}  // namespace sunder
