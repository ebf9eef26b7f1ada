// SPDX-License-Identifier: Apache-2.0
// Measures of a stress in Voigt order (xx, yy, zz, xy, yz, zx), all in MPa.
#pragma once

#include "sunder/scene.hpp"

namespace sunder {

/// Tensor of a stress in Voigt order.
[[nodiscard]] Mat3 tensor(const Voigt& stress);

/// Principal stresses, descending.
[[nodiscard]] Vec3 principal_stresses(const Voigt& stress);

/// Maximum shear stress (s1 - s3)/2.
[[nodiscard]] double max_shear(const Voigt& stress);

/// The chosen measure of a stress (method.md "Elasticity" 2).
[[nodiscard]] double yield_measure(const Voigt& stress, YieldMeasure measure);

}  // namespace sunder
