// SPDX-License-Identifier: Apache-2.0
// Damping by stiffness (Kelvin-Voigt): a viscous second Piola-Kirchhoff stress of b D de/dt, D the
// stiffness at small strain and e Green's strain, so that no rotation brings any and nothing is
// turned by it; by law "linear" e is the strain of small displacements. The rate of a step is
// rate (e - from), from what a scheme in time says of the states before.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "body/hyperelastic.hpp"

namespace sunder::fem {

class Viscosity {
 public:
  /// The problem and what `body` refers to must outlive it; what is destroyed is read live.
  explicit Viscosity(const HyperelasticBody& body);

  /// from = now e(u) - before e(u_before), of displacements (3 * nodes).
  void start(std::span<const double> u, double now, std::span<const double> u_before,
             double before);
  /// f = d potential / du, potential = sum of V factor/2 (e - from) : D : (e - from) [N mm], over
  /// 3 * nodes. Returns the potential.
  double forces(std::span<const double> u, double factor, std::span<double> f) const;
  /// df/du of a live element, 12 x 12.
  [[nodiscard]] ElementMatrix tangent(Index e, std::span<const double> u, double factor) const;

  /// Of each element: what its strain is measured from; so often start() has set it.
  [[nodiscard]] std::span<const Mat3> from() const { return from_; }
  [[nodiscard]] std::uint64_t starts() const { return starts_; }

 private:
  [[nodiscard]] Mat3 strain(const Mat3& h, Index e) const;
  [[nodiscard]] Mat3 stress(const Mat3& strain, double factor, Index e) const;

  HyperelasticBody body_;
  std::vector<Mat3> from_;  // per element
  std::uint64_t starts_ = 0;
};

}  // namespace sunder::fem
