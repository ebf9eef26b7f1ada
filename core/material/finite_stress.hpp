// SPDX-License-Identifier: Apache-2.0
// The stresses at finite deformation that a criterion may read (Holzapfel 2000, 3.3 and 3.4), from
// the first Piola-Kirchhoff stress P [MPa].
#pragma once

#include "sunder/types.hpp"

namespace sunder {

/// Cauchy's, the true stress in the deformed body: P F^T/J. F must not be singular.
[[nodiscard]] Voigt cauchy_stress(const Mat3& p, const Mat3& f);
/// Biot's, the nominal stress in the material's frame: sym(R^T P) with F = R S.
[[nodiscard]] Voigt biot_stress(const Mat3& p, const Mat3& f);

}  // namespace sunder
