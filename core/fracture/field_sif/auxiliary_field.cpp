// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/auxiliary_field.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace sunder::fracture {
namespace {

using Complex = std::complex<double>;

// Eigen's matrices and std::complex keep their NaN checks out of this inner loop.
Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// 1/sqrt(2 pi z) on the sheet of `side`: cut along the negative real axis, continued across it.
Complex inverse_root(const Vec2& x, double r, int side) {
  const double c = x.x() / r;
  const double half_cos = std::sqrt(std::max((1 + c) / 2, 0.0));
  const double half_sin = std::sqrt(std::max((1 - c) / 2, 0.0));
  const double scale = 1 / std::sqrt(2 * std::numbers::pi * r);
  const int upper = x.y() > 0 || (x.y() == 0 && side >= 0) ? 1 : -1;
  // Behind the tip and on the other side than its x2 says: once around, the root changes sign.
  const double sheet = side != 0 && x.x() < 0 && side != upper ? -1 : 1;
  return {sheet * scale * half_cos, -sheet * scale * upper * half_sin};
}

/// Kolosov-Muskhelishvili: s11 + s22 = 4 Re Phi, s22 - s11 + 2 i s12 = 2 (conj(z) Phi' + Psi),
/// 2 mu (u1,1 + i u2,1) = kappa Phi - conj(Phi + conj(z) Phi' + Psi).
AuxiliaryState in_plane_state(Complex phi, Complex turned, const TipMaterial& m, double kappa) {
  const double mean = 2 * phi.real();
  const Complex slope = kappa * phi - std::conj(phi + turned);
  AuxiliaryState state;
  state.stress.setZero();
  state.stress(0, 0) = mean - turned.real();
  state.stress(1, 1) = mean + turned.real();
  state.stress(0, 1) = state.stress(1, 0) = turned.imag();
  state.stress(2, 2) = m.constraint * m.poisson * 2 * mean;
  state.slope = Vec3(slope.real(), slope.imag(), 0) / (2 * m.shear());
  return state;
}

/// s13 - i s23 = mu (u3,1 - i u3,2) = -i w.
AuxiliaryState anti_plane_state(Complex w, const TipMaterial& m) {
  AuxiliaryState state;
  state.stress.setZero();
  state.stress(0, 2) = state.stress(2, 0) = w.imag();
  state.stress(1, 2) = state.stress(2, 1) = w.real();
  state.slope = Vec3(0, 0, w.imag() / m.shear());
  return state;
}

}  // namespace

double TipMaterial::kolosov() const {
  const double nu = (poisson + constraint * poisson * poisson) /
                    (1 - constraint * poisson * poisson);  // of the equivalent plane stress
  return (3 - nu) / (1 + nu);
}

std::array<AuxiliaryState, kModes> auxiliary_states(const Vec2& x, int side,
                                                    const TipMaterial& material) {
  const double r = x.norm(), kappa = material.kolosov();
  const Complex w = inverse_root(x, r, side);  // 1/sqrt(2 pi z)
  const Complex z_bar_over_z = times({x.x() / r, -x.y() / r}, {x.x() / r, -x.y() / r});
  std::array<AuxiliaryState, kModes> states;
  // Phi = (K_I - i K_II)/(2 sqrt(2 pi z)); z Phi' = -Phi/2; Psi = conj(Phi(conj z)) - Phi/2.
  const Complex phi_1 = w / 2.0, phi_2 = times({0, -1}, phi_1);
  const Complex turned_1 = phi_1 / 2.0 - times(z_bar_over_z, phi_1) / 2.0;
  const Complex turned_2 = -1.5 * phi_2 - times(z_bar_over_z, phi_2) / 2.0;
  states[kModeI] = in_plane_state(phi_1, turned_1, material, kappa);
  states[kModeII] = in_plane_state(phi_2, turned_2, material, kappa);
  // u3 = 2/mu Im sqrt(z/(2 pi)).
  states[kModeIII] = anti_plane_state(w, material);
  return states;
}

std::array<AuxiliaryState, kModes> shift_states(const Vec2& x, int side,
                                                const TipMaterial& material) {
  const double r = x.norm(), kappa = material.kolosov();
  // sqrt(z/(2 pi)). A crack that ends at -d: 1/sqrt(2 pi (z + d)) = (1 - d/(2 z))/sqrt(2 pi z) +
  // ...
  const Complex w = -2.0 * times({x.x(), x.y()}, inverse_root(x, r, side));
  const Complex z_bar_over_z = times({x.x() / r, -x.y() / r}, {x.x() / r, -x.y() / r});
  std::array<AuxiliaryState, kModes> states;
  // z Phi' = Phi/2; Psi = conj(Phi(conj z)) - 3/2 Phi.
  const Complex phi_1 = w / 2.0, phi_2 = times({0, -1}, phi_1);
  const Complex turned_1 = times(z_bar_over_z, phi_1) / 2.0 - phi_1 / 2.0;
  const Complex turned_2 = times(z_bar_over_z, phi_2) / 2.0 - 2.5 * phi_2;
  states[kModeI] = in_plane_state(phi_1, turned_1, material, kappa);
  states[kModeII] = in_plane_state(phi_2, turned_2, material, kappa);
  states[kModeIII] = anti_plane_state(w, material);
  return states;
}

}  // namespace sunder::fracture
