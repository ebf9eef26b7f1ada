// SPDX-License-Identifier: Apache-2.0
// Displacement near a crack tip of unit stress intensity, in polar form (Williams 1957; Irwin
// 1958): an independent form of what core/fracture/field_sif/auxiliary_field.hpp has as functions
// of a complex variable.
#pragma once

#include <cmath>
#include <numbers>

#include "fracture/field_sif/auxiliary_field.hpp"

namespace sunder::test {

inline Vec3 williams(const Vec2& x, int mode, const fracture::TipMaterial& material) {
  const double half = std::atan2(x.y(), x.x()) / 2, c = std::cos(half), s = std::sin(half);
  const double root = std::sqrt(x.norm() / (2 * std::numbers::pi)), mu = material.shear();
  const double kappa = material.kolosov();
  if (mode == fracture::kModeI)
    return root / (2 * mu) * Vec3(c * (kappa - 1 + 2 * s * s), s * (kappa + 1 - 2 * c * c), 0);
  if (mode == fracture::kModeII)
    return root / (2 * mu) * Vec3(s * (kappa + 1 + 2 * c * c), -c * (kappa - 1 - 2 * s * s), 0);
  return Vec3(0, 0, 2 / mu * root * s);
}

}  // namespace sunder::test
