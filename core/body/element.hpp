// SPDX-License-Identifier: Apache-2.0
// The constant-strain tetrahedron: strain, stiffness, stress, update vectors (method.md
// "Elasticity" 1 and 3). Voigt order (xx, yy, zz, xy, yz, zx), engineering shear.
#pragma once

#include <Eigen/Core>

#include "material/linear.hpp"
#include "sunder/problem.hpp"

namespace sunder::fem {

using StrainDisplacement = Eigen::Matrix<double, 6, 12>;  ///< B; columns 3 a + axis
using ElementMatrix = Eigen::Matrix<double, 12, 12>;
using UpdateFactor = Eigen::Matrix<double, 12, 6>;

/// Shape of the tetrahedron with these corners; volume is signed.
[[nodiscard]] TetShape tet_shape(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3);

[[nodiscard]] StrainDisplacement strain_displacement(const TetShape& shape);

/// K_e = V B^T D B [N/mm].
[[nodiscard]] ElementMatrix element_stiffness(const TetShape& shape, const Matrix6& d);

/// U_e = B^T L sqrt(V (1 - alpha)) with D = L L^T, so that (1 - alpha) K_e = U_e U_e^T.
[[nodiscard]] UpdateFactor update_factor(const TetShape& shape, const SmallStrain& law,
                                         double alpha);

/// Stress of a live element from its corners' displacement (columns: nodes), taken from the
/// differences to corner 0: a rigid translation costs no accuracy.
[[nodiscard]] Voigt stress(const TetShape& shape, const SmallStrain& law,
                           const Eigen::Matrix<double, 3, 4>& displacement);

/// The law of what an element bears by itself: where its volume is pooled the pressure is its
/// patch's (pools.hpp), and the deviator alone its own.
[[nodiscard]] SmallStrain own_law(const Problem& problem, Index e);

/// K_e, U_e, and stress from the displacement at all nodes (3 * nodes), of what a problem's element
/// bears by itself.
[[nodiscard]] ElementMatrix element_stiffness(const Problem& problem, Index e);
[[nodiscard]] UpdateFactor update_factor(const Problem& problem, Index e);
[[nodiscard]] Voigt stress_by_itself(const Problem& problem, Index e, std::span<const double> u);

/// Corners' displacement of element e from the displacement at all nodes (3 * nodes).
[[nodiscard]] Eigen::Matrix<double, 3, 4> corner_displacement(const Mesh& mesh, Index e,
                                                              std::span<const double> u);

}  // namespace sunder::fem
