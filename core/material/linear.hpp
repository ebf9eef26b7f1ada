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

/// Stress of a displacement gradient H_ij = du_i/dx_j [MPa].
[[nodiscard]] Voigt stress(const SmallStrain& law, const Mat3& gradient);

/// The same as a law of F: P = stress of F - I. It takes a rotation for strain.
extern const Law kLinear;

}  // namespace sunder
