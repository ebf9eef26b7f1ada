// SPDX-License-Identifier: Apache-2.0
// What a law is at small strain, as numbers: the only place that others read a material's stiffness
// from (core/material).
#pragma once

#include <algorithm>

namespace sunder {

struct ElementFibres;

/// Isotropic linear elasticity. Stress s = 2 mu e + lambda tr(e) I of the strain e.
struct SmallStrain {
  double young = 0;           ///< E [MPa]
  double poisson = 0;         ///< nu
  double lambda = 0, mu = 0;  ///< Lame's constants [MPa]
  double triple_bulk = 0;     ///< 3 lambda + 2 mu = E / (1 - 2 nu) [MPa]
  double double_shear = 0;    ///< 2 mu = E / (1 + nu) [MPa]
  /// Of its element, which the law adds to the above (material/fibres.hpp); null: none.
  const ElementFibres* fibres = nullptr;
  /// Largest eigenvalue of the elasticity of tensors: |s|^2 <= stiffest() (s : e) [MPa].
  [[nodiscard]] double stiffest() const { return std::max(triple_bulk, double_shear); }
};

}  // namespace sunder
