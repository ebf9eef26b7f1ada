// SPDX-License-Identifier: Apache-2.0
// The cases in which measured stress intensity factors meet published ones, shared by the tests
// and by the program that writes the verification table.
#pragma once

#include <string>
#include <vector>

#include "core/field_sif/cracked_board.hpp"

namespace sunder::test {

enum class Notch { edge, centre };

/// A strip W = n cells wide (centre crack: half of it, mirrored) and 6 W high under unit tension;
/// rows grow from W/2 above and below the crack on. The crack ends where its deleted row ends.
[[nodiscard]] CrackedBoard notched_strip(Notch notch, int n, double share,
                                         const CrackedBoardOptions& options = {});
[[nodiscard]] double published_intensity(Notch notch, int n, double share);

/// K from the energy release between cracks one cell shorter and one cell longer; `constraint` as
/// in TipMaterial.
[[nodiscard]] double energy_release_intensity(Notch notch, int n, double share, int layers = 1,
                                              double constraint = 0);

/// A crack of length 2a, a = `cells` cells, in the middle of a plate 20 a wide; cells grow with the
/// distance from the crack.
[[nodiscard]] CrackedBoard wide_plate(int cells, double h, const CrackedBoardOptions& options = {});

/// As notched_strip with an edge notch, `layers` cells thick.
[[nodiscard]] CrackedBoard thick_strip(int n, double share, int layers, bool held_flat);

/// A strip held in its plane and sheared along its thickness by unit stress at top and bottom: mode
/// III alone, the same in every plane.
[[nodiscard]] CrackedBoard antiplane_strip(int n, double share);

/// Ring radii in cells [mm for h = 1].
inline constexpr double kRing = 6.0;

}  // namespace sunder::test
