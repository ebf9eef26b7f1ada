// SPDX-License-Identifier: Apache-2.0
// A material law: energy, stress and tangent at any deformation. Every law here is isotropic and
// hyperelastic and equals "linear" at small strain, so that the same two constants state it. To all
// of them the fibres of an element are added (fibres.hpp), where its constants have any.
#pragma once

#include <span>
#include <string_view>

#include "material/fibres.hpp"
#include "material/spectral_tangent.hpp"
#include "sunder/small_strain.hpp"

namespace sunder {

/// A law's energy as one of shape and one of volume, W(F) = W_s(F) + U(J), for elements that change
/// their volume together (method.md "Pooled volume"). J is the ratio of volumes as the law measures
/// it: det F, or 1 and the trace of its strain. W_s is 0 wherever nothing changes its shape.
struct VolumeSplit {
  double (*shape_energy)(const SmallStrain&, const Mat3& f);
  Mat3 (*shape_stress)(const SmallStrain&, const Mat3& f);
  /// Second derivative of W_s(F) + p J(F).
  SpectralTangent (*shape_tangent)(const SmallStrain&, const Mat3& f, double pressure);
  double (*ratio)(const Mat3& f);      ///< J
  Mat3 (*ratio_slope)(const Mat3& f);  ///< dJ/dF
  /// U, p = U' and U''; an infinite energy where the law knows no such volume [MPa].
  struct Volume {
    double energy, pressure, stiffness;
  };
  Volume (*volume)(const SmallStrain&, double j);
};

/// F is the deformation gradient dx/dX = I + du/dX. No function of a law allocates.
struct Law {
  std::string_view name;  ///< as a scene's key `law` will say it
  /// W per undeformed volume [MPa], 0 at F = I; infinite where the law knows no such state.
  double (*energy)(const SmallStrain&, const Mat3& f);
  /// First Piola-Kirchhoff stress P = dW/dF [MPa]; F must have an energy.
  Mat3 (*stress)(const SmallStrain&, const Mat3& f);
  /// dP/dF; F must have an energy.
  SpectralTangent (*tangent)(const SmallStrain&, const Mat3& f);
  /// Null: no part of the energy is one of volume alone.
  const VolumeSplit* split = nullptr;
};

/// A law by what it is without fibres.
template <FibreTheory kTheory, auto kEnergy, auto kStress, auto kTangent>
constexpr Law law_with_fibres(std::string_view name, const VolumeSplit* split = nullptr) {
  return {name,
          [](const SmallStrain& of, const Mat3& f) {
            const double w = kEnergy(of, f);
            return of.fibres ? w + fibre_energy<kTheory>(*of.fibres, f) : w;
          },
          [](const SmallStrain& of, const Mat3& f) {
            const Mat3 p = kStress(of, f);
            return of.fibres ? Mat3(p + fibre_stress<kTheory>(*of.fibres, f)) : p;
          },
          [](const SmallStrain& of, const Mat3& f) {
            if (!of.fibres) return kTangent(of, f);
            return with_fibres(kTangent(of, f), fibre_tangent<kTheory>(*of.fibres, f));
          },
          split};
}

/// Its split: fibres are of all of F, each element's own, and never of the volume that a patch
/// shares.
template <FibreTheory kTheory, auto kEnergy, auto kStress, auto kTangent, auto kRatio,
          auto kRatioSlope, auto kVolume>
constexpr VolumeSplit split_with_fibres() {
  return {[](const SmallStrain& of, const Mat3& f) {
            const double w = kEnergy(of, f);
            return of.fibres ? w + fibre_energy<kTheory>(*of.fibres, f) : w;
          },
          [](const SmallStrain& of, const Mat3& f) {
            const Mat3 p = kStress(of, f);
            return of.fibres ? Mat3(p + fibre_stress<kTheory>(*of.fibres, f)) : p;
          },
          [](const SmallStrain& of, const Mat3& f, double pressure) {
            if (!of.fibres) return kTangent(of, f, pressure);
            return with_fibres(kTangent(of, f, pressure), fibre_tangent<kTheory>(*of.fibres, f));
          },
          kRatio,
          kRatioSlope,
          kVolume};
}

/// "linear", "corotated", "neo-hookean", "saint-venant-kirchhoff".
[[nodiscard]] std::span<const Law* const> laws();
/// By its name; none: nullptr.
[[nodiscard]] const Law* find_law(std::string_view name);

}  // namespace sunder
