// SPDX-License-Identifier: Apache-2.0
// A material law: energy, stress and tangent at any deformation. Every law here is isotropic and
// hyperelastic and equals "linear" at small strain, so that the same two constants state it.
#pragma once

#include <span>
#include <string_view>

#include "material/spectral_tangent.hpp"
#include "sunder/small_strain.hpp"

namespace sunder {

/// F is the deformation gradient dx/dX = I + du/dX. No function of a law allocates.
struct Law {
  std::string_view name;  ///< as a scene's key `law` will say it
  /// W per undeformed volume [MPa], 0 at F = I; infinite where the law knows no such state.
  double (*energy)(const SmallStrain&, const Mat3& f);
  /// First Piola-Kirchhoff stress P = dW/dF [MPa]; F must have an energy.
  Mat3 (*stress)(const SmallStrain&, const Mat3& f);
  /// dP/dF; F must have an energy.
  SpectralTangent (*tangent)(const SmallStrain&, const Mat3& f);
};

/// "linear", "corotated", "neo-hookean", "saint-venant-kirchhoff".
[[nodiscard]] std::span<const Law* const> laws();
/// By its name; none: nullptr.
[[nodiscard]] const Law* find_law(std::string_view name);

}  // namespace sunder
