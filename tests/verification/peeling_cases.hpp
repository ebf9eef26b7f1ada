// SPDX-License-Identifier: Apache-2.0
// Peeling against the energy of the interface: structured strips one cell wide, in plane strain,
// by grips that move in small steps. The cases of the page and of bench_peeling.
#pragma once

#include <array>
#include <string>

#include "sunder/types.hpp"

namespace sunder::test {

/// Strips of .6 mm by the media of an aorta (E .5 MPa, nu .45; interface .14 MPa, .0458 N/mm):
///   at_90, at_180   from a rigid bed, at the angle of the pull to what is still bonded
///   t_peel          two strips, one held by its end, the other one pulled
/// and two arms of 2 mm, E 100 MPa, nu .3, interface .2 MPa and .01 N/mm: double_cantilever.
enum class Peel { at_90, at_180, t_peel, double_cantilever };
inline constexpr std::array kPeels{Peel::at_90, Peel::at_180, Peel::t_peel,
                                   Peel::double_cantilever};
[[nodiscard]] std::string name_of(Peel peel);

/// Edge of a cell [mm] on the coarsest mesh; half and a quarter of it on the others.
[[nodiscard]] double coarse_cell(Peel peel);

/// Over the part of the way where the force is steady.
struct PeelFigures {
  Index tets = 0;  ///< layer included
  /// Force per width over that of rigid strips, G_c / (1 - cos angle) (T-peel: G_c / 2), and over
  /// that of strips that stretch. Double cantilever: force over that of two beams on the
  /// interface's springs, in both.
  double over_rigid = 0, mean = 0, least = 0, largest = 0;
  double work = 0;    ///< of the grip, less what is stored, over G_c times the area parted
  double parted = 0;  ///< energy of the pairs that have parted over G_c times their area
  int rows = 0;       ///< of nodes that have parted
  double ms = 0;      ///< all of the way
};
/// `finer`: 1, 2 or 4; `per_cell`: steps of the grip while the edge moves on by a cell.
[[nodiscard]] PeelFigures peel(Peel peel, Index finer, double per_cell = 4);

}  // namespace sunder::test
