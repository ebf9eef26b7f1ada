// SPDX-License-Identifier: Apache-2.0
// The volume part of laws whose energy is mu |E|^2 + lambda/2 (tr E)^2 of some strain E
// (VolumeSplit): J = 1 + tr E, U = kappa/2 (J - 1)^2, and W_s is the law itself without its
// pressure.
#pragma once

#include "material/law.hpp"

namespace sunder {

inline VolumeSplit::Volume trace_volume(const SmallStrain& law, double j) {
  const double kappa = law.triple_bulk / 3, dilation = j - 1;
  return {kappa / 2 * dilation * dilation, kappa * dilation, kappa};
}

}  // namespace sunder
