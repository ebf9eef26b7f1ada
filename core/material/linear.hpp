// SPDX-License-Identifier: Apache-2.0
// Isotropic linear elasticity (method.md "Elasticity" 1): the law "linear", and what every other
// law is at small strain. Young's modulus and Poisson's ratio become numbers here and nowhere else.
#pragma once

#include <Eigen/Core>

#include "material/law.hpp"
#include "sunder/scene.hpp"
#include "sunder/small_strain.hpp"

namespace sunder {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

[[nodiscard]] SmallStrain small_strain(const Material& material);

/// D of stress = D strain, Voigt order (xx, yy, zz, xy, yz, zx), engineering shear [MPa].
[[nodiscard]] Matrix6 elasticity(const SmallStrain& law);

/// The same law without its resistance to a change of volume: its stress has no mean.
[[nodiscard]] SmallStrain without_pressure(const SmallStrain& law);

/// L with L L^T = D. Without pressure D has rank 5, and L's third column is 0.
[[nodiscard]] Matrix6 elasticity_factor(const SmallStrain& law);

/// Stress of a displacement gradient H_ij = du_i/dx_j [MPa]. Inline: criteria ask for it element by
/// element.
[[nodiscard]] inline Voigt stress(const SmallStrain& law, const Mat3& h) {
  const double mu = law.mu, pressure = law.lambda * h.trace();
  Voigt s;
  s << pressure + 2 * mu * h(0, 0), pressure + 2 * mu * h(1, 1), pressure + 2 * mu * h(2, 2),
      mu * (h(0, 1) + h(1, 0)), mu * (h(1, 2) + h(2, 1)), mu * (h(2, 0) + h(0, 2));
  return s;
}

/// The same as a law of F: P = stress of F - I. It takes a rotation for strain.
extern const Law kLinear;

}  // namespace sunder
