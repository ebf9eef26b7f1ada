// SPDX-License-Identifier: Apache-2.0
// Fibres of an element (method.md "Fibres"), added to what its law is without them.
//
// Finite deformation, per family (Holzapfel, Gasser and Ogden 2000; dispersion by Gasser, Ogden and
// Holzapfel 2006; invariants of all of F, not of its isochoric part, by Nolan et al. 2014):
// E = kappa (I1 - 3) + (1 - 3 kappa) (I4 - 1) = tr(F A F^T) - 1, A = kappa I + (1 - 3 kappa) a a^T,
// W = k1/(2 k2) (exp(k2 E^2) - 1) where E > 0, else 0. As E is convex in F and W grows with it, the
// tangent of fibres is positive semidefinite everywhere.
//
// Law "linear": the transversely isotropic elasticity (Spencer 1984) less the isotropic one.
#pragma once

#include <array>

#include "material/spectral_tangent.hpp"
#include "sunder/small_strain.hpp"
#include "sunder/types.hpp"

namespace sunder {

struct FibreFamily {
  Vec3 direction = Vec3::Zero();          ///< unit vector, undeformed
  double k1 = 0, k2 = 0, dispersion = 0;  ///< [MPa], 1, kappa in [0, 1/3]
};

/// Of law "linear", against isotropy: Spencer's lambda - lambda_0, alpha, beta, mu_L - mu_T [MPa].
struct AlongFibres {
  double lambda = 0, alpha = 0, beta = 0, mu = 0;
};

struct ElementFibres {
  int count = 0;  ///< of families, at most 2; one for law "linear"
  std::array<FibreFamily, 2> family;
  AlongFibres linear;
};

/// How a law takes them.
enum class FibreTheory { finite, linear };

/// What fibres add to W [MPa]; infinite where k2 E^2 > 100, stress no tissue bears.
template <FibreTheory kTheory>
[[nodiscard]] double fibre_energy(const ElementFibres& fibres, const Mat3& f);
/// To P [MPa].
template <FibreTheory kTheory>
[[nodiscard]] Mat3 fibre_stress(const ElementFibres& fibres, const Mat3& f);
/// To dP/dF.
template <FibreTheory kTheory>
[[nodiscard]] Matrix9 fibre_tangent(const ElementFibres& fibres, const Mat3& f);

template <>
double fibre_energy<FibreTheory::finite>(const ElementFibres& fibres, const Mat3& f);
template <>
Mat3 fibre_stress<FibreTheory::finite>(const ElementFibres& fibres, const Mat3& f);
template <>
Matrix9 fibre_tangent<FibreTheory::finite>(const ElementFibres& fibres, const Mat3& f);
template <>
double fibre_energy<FibreTheory::linear>(const ElementFibres& fibres, const Mat3& f);
template <>
Mat3 fibre_stress<FibreTheory::linear>(const ElementFibres& fibres, const Mat3& f);
template <>
Matrix9 fibre_tangent<FibreTheory::linear>(const ElementFibres& fibres, const Mat3& f);

/// By which a stress is large or small [MPa]: mu, and of fibres a third of their modulus in
/// tension.
[[nodiscard]] double shear_scale(const SmallStrain& of);

/// Modes of a sum.
[[nodiscard]] SpectralTangent with_fibres(const SpectralTangent& without, const Matrix9& fibres);

}  // namespace sunder
