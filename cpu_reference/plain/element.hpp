// SPDX-License-Identifier: Apache-2.0
// One tetrahedron, from the definitions, in extended precision. It shares no formula with core:
// shape functions by inverting [1 x y z], elasticity by inverting the compliance of E and nu.
#pragma once

#include <Eigen/Core>
#include <array>

#include "sunder/mesh.hpp"
#include "sunder/scene.hpp"

namespace sunder::plain {

using Real = long double;
using Real3x3 = Eigen::Matrix<Real, 3, 3>;
using Real6 = Eigen::Matrix<Real, 6, 1>;
using Real12 = Eigen::Matrix<Real, 12, 1>;

/// Voigt order (xx, yy, zz, xy, yz, zx), engineering shear.
struct Element {
  Element(const Mesh& mesh, Index e, const Material& material);
  [[nodiscard]] Eigen::Matrix<Real, 12, 12> stiffness() const {
    return share * volume * (b.transpose() * d * b);
  }

  /// Of its corners, out of the displacement (3 * nodes) of a body.
  template <class Displacement>
  [[nodiscard]] Real12 corners(const Displacement& u) const {
    Real12 of;
    for (std::size_t i = 0; i < places.size(); ++i) of[static_cast<Index>(i)] = u[places[i]];
    return of;
  }
  [[nodiscard]] Real6 stress(const Real12& u) const { return share * (d * (b * u)); }
  [[nodiscard]] Real12 forces(const Real12& u) const {
    return volume * (b.transpose() * stress(u));
  }
  [[nodiscard]] Real3x3 gradient(const Real12& u) const;        ///< row i: that of u_i
  [[nodiscard]] Eigen::Matrix<Real, 1, 3> slope(int a) const {  ///< of N_a
    return {b(0, 3 * a), b(3, 3 * a), b(5, 3 * a)};
  }

  std::array<std::size_t, 12> places;  ///< 3 * node + axis of its dofs
  Real volume = 0;                     ///< [mm^3]
  Eigen::Matrix<Real, 6, 12> b;        ///< strain of the corners' displacement [1/mm]
  Eigen::Matrix<Real, 6, 6> d;         ///< stress of a strain [MPa]
  Real share = 1;                      ///< of its stiffness that is left: 1, or alpha
};

/// Principal values of a symmetric tensor, ascending.
[[nodiscard]] Eigen::Matrix<Real, 3, 1> principal_values(const Real3x3& tensor);
/// Angle [deg] of the rotation nearest to F = I + grad u, by singular values.
[[nodiscard]] Real rotation_deg(const Real3x3& gradient);

}  // namespace sunder::plain
