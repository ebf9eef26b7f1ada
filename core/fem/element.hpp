// SPDX-License-Identifier: Apache-2.0
// The constant-strain tetrahedron: strain, stiffness, stress, update vectors (method.md
// "Elasticity" 1 and 3). Voigt order (xx, yy, zz, xy, yz, zx), engineering shear.
#pragma once

#include <Eigen/Core>

#include "sunder/problem.hpp"

namespace sunder::fem {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using StrainDisplacement = Eigen::Matrix<double, 6, 12>;  ///< B; columns 3 a + axis
using ElementMatrix = Eigen::Matrix<double, 12, 12>;
using UpdateFactor = Eigen::Matrix<double, 12, 6>;

/// Shape of the tetrahedron with these corners; volume is signed.
[[nodiscard]] TetShape tet_shape(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3);

/// D of isotropic linear elasticity [MPa].
[[nodiscard]] Matrix6 elasticity(double young, double poisson);

[[nodiscard]] StrainDisplacement strain_displacement(const TetShape& shape);

/// K_e = V B^T D B [N/mm].
[[nodiscard]] ElementMatrix element_stiffness(const TetShape& shape, const Matrix6& d);

/// U_e = B^T L sqrt(V (1 - alpha)) with D = L L^T, so that (1 - alpha) K_e = U_e U_e^T.
[[nodiscard]] UpdateFactor update_factor(const TetShape& shape, const Matrix6& d, double alpha);

/// Stress of a live element from its corners' displacement (columns: nodes), taken from the
/// differences to corner 0: a rigid translation costs no accuracy.
[[nodiscard]] Voigt stress(const TetShape& shape, const Material& material,
                           const Eigen::Matrix<double, 3, 4>& displacement);

/// Tensor of a stress in Voigt order.
[[nodiscard]] Mat3 tensor(const Voigt& stress);

/// Principal stresses, descending.
[[nodiscard]] Vec3 principal_stresses(const Voigt& stress);

/// Maximum shear stress (s1 - s3)/2.
[[nodiscard]] double max_shear(const Voigt& stress);

/// The chosen measure of a stress (method.md "Elasticity" 2).
[[nodiscard]] double yield_measure(const Voigt& stress, YieldMeasure measure);

/// A bound on the stress that rounding displacements to fp64 costs an element [MPa], where the
/// largest is `largest_u` [mm]: half an ulp of it times the largest |D| |B|.
[[nodiscard]] double stress_of_rounding(const Problem& problem, double largest_u);

/// Corners' displacement of element e from the displacement at all nodes (3 * nodes).
[[nodiscard]] Eigen::Matrix<double, 3, 4> corner_displacement(const Mesh& mesh, Index e,
                                                              std::span<const double> u);

}  // namespace sunder::fem
