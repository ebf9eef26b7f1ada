// SPDX-License-Identifier: Apache-2.0
// Where a crack under mixed mode goes: along the maximum tangential stress at its tip (Erdogan and
// Sih 1963).
#pragma once

namespace sunder::fracture {

/// theta_c [rad] from the crack's direction, counter-clockwise positive; |theta_c| <= 70.53 deg.
/// K_I < 0 closes the crack and counts 0. No stress intensity: 0.
[[nodiscard]] double tangential_angle(double k_1, double k_2);

/// Stress intensity of the mode I state with the same tangential stress at theta:
/// K_I cos^3(theta/2) - 3/2 K_II cos(theta/2) sin(theta), K_I >= 0 [MPa sqrt(mm)].
[[nodiscard]] double tangential_intensity(double k_1, double k_2, double theta);

}  // namespace sunder::fracture
