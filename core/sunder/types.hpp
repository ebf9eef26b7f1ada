// SPDX-License-Identifier: Apache-2.0
// The few numeric types of the public interface. Units throughout: mm, N, MPa.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace sunder {

using Index = std::int32_t;  ///< 0-based id of a node, an element or a degree of freedom (dof)
inline constexpr Index kNone = -1;

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// Stress or strain in Voigt order (xx, yy, zz, xy, yz, zx); strains carry engineering shear.
using Voigt = Eigen::Matrix<double, 6, 1>;

/// A set of coordinate axes as a bit mask: x = 1, y = 2, z = 4.
struct Axes {
  std::uint8_t bits = 7;
  [[nodiscard]] constexpr bool has(int axis) const { return (bits >> axis) & 1; }
  friend bool operator==(Axes, Axes) = default;
};

}  // namespace sunder
