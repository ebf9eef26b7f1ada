// SPDX-License-Identifier: Apache-2.0
// Nearly incompressible bodies, by elements and by patches of pooled volume, against solutions that
// do not lock: the cases of the test and of the page.
#pragma once

#include "sunder/scene.hpp"

namespace sunder::test {

/// Thick cylinder in plane strain, inner radius 10, outer 20 mm, E 1 MPa, under inner pressure;
/// a quarter of it, `cells` through the wall, 2 cells of angle for each, one cell long.
struct LameErrors {
  double u = 0;       ///< mean radial displacement of the inner wall: relative, signed
  double tresca = 0;  ///< volume-weighted root mean square over elements, relative
};
[[nodiscard]] LameErrors lame_errors(MaterialVolume volume, double poisson, Index cells);

/// Cook's membrane of small strain on cells x cells, nu .4999, E 240.565 MPa (mu 80.1938, kappa
/// 400889.8), shear 6.25: vertical displacement at (48, 60) [mm].
[[nodiscard]] double incompressible_cook(MaterialVolume volume, Index cells);

/// The same by law "neo-hookean", in so many steps of the load. 6.97 by quadratic tetrahedra.
[[nodiscard]] double neo_hookean_cook(MaterialVolume volume, Index cells, int steps);

/// A block 10 x 10 x 5 mm of n x n x n/2 cells, E 1, nu .4999, bonded below and above to plates of
/// which the upper comes down by .1 mm: force on it [N]. 3.45 by quadratic tetrahedra.
[[nodiscard]] double bonded_block_force(MaterialVolume volume, Index n);
/// The same block by law "neo-hookean", pooled, where the plate comes down by a thousandth of that;
/// a thousand times its force.
[[nodiscard]] double neo_hookean_block_force(Index n);

}  // namespace sunder::test
