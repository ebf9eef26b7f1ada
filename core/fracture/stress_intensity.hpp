// SPDX-License-Identifier: Apache-2.0
// Eq. 1-4 of Kume et al. 2013 as pure functions (method.md 6-9). K in MPa sqrt(mm), stress in MPa,
// lengths in mm, pressure P in N/mm of thickness, angles in radians.
#pragma once

#include "sunder/types.hpp"

namespace sunder::fracture {

/// Eq. 3: K_a of the remote stress s0 under the angle beta between crack normal and n1;
/// `factor` is the geometry factor F. Compression opens nothing.
[[nodiscard]] double expansion_intensity(double factor, double cos_beta, double s0, double a);

/// Eq. 4: K_b of the balanced pair 2 min(Pu, Pl) at the distance b' from the tip.
[[nodiscard]] double balanced_intensity(double upper, double lower, double distance);

/// Eq. 4: K_c of the surplus |Pu - Pl| on one face at the distance b' from the tip.
[[nodiscard]] double one_sided_intensity(double upper, double lower, double distance);

/// s of Eq. 2: +1 when the surplus pushes along the expansion's resultant force, -1 against it,
/// +1 when it does neither (under 1e-9 of |resultant|).
[[nodiscard]] double pressure_sign(const Vec3& opening, const Vec3& resultant);

/// Eq. 2: K = max(K_a + K_b + s K_c, 0).
[[nodiscard]] double total_intensity(double k_a, double k_b, double k_c, double sign);

/// Angle from d to v, counter-clockwise positive, clamped to a right angle either way.
[[nodiscard]] double growth_angle(const Vec2& d, const Vec2& v);

/// [cos(theta/2) (1 + sin(|theta|/2))]^2, the shape of the Tresca zone; largest, 27/16, at 60 deg.
[[nodiscard]] double zone_shape(double theta);

/// Eq. 1: reach r_e of the Tresca zone in an element of the given yield stress.
[[nodiscard]] double reach(double k, double yield, double theta);

/// The left normal of a direction in the plane, e1 to the right and e2 up.
[[nodiscard]] inline Vec2 left_of(const Vec2& d) { return {-d.y(), d.x()}; }

/// d turned counter-clockwise by theta.
[[nodiscard]] Vec2 turned(const Vec2& d, double theta);

}  // namespace sunder::fracture
