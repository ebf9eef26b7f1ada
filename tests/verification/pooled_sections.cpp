// SPDX-License-Identifier: Apache-2.0
#include "verification/page.hpp"
#include "verification/pooled_cases.hpp"
#include "verification/sections.hpp"

namespace sunder::test {
namespace {

using enum MaterialVolume;

std::string signed_percent(double share) { return text("%+.2f %%", 100 * share); }

void write_lame(std::ostream& out) {
  out << "\n## Thick cylinder, pooled volume\nPlane strain, inner radius 10, outer 20 mm, under "
         "inner pressure; a quarter of it, 1,728 tetrahedra (12 cells through the wall). "
         "Reference: Lame. "
         "Displacement of the inner wall; Tresca stress as root mean square over all elements. "
         "Target: 1 % and 3 %.\n"
      << head({"nu", "pooled: displacement", "pooled: stress", "element: displacement",
               "element: stress"});
  for (double nu : {0.3, 0.4, 0.49, 0.499, 0.4999}) {
    const LameErrors pool = lame_errors(pooled, nu, 12), one = lame_errors(element, nu, 12);
    out << line({text("%g", nu), signed_percent(pool.u), text("%.2f %%", 100 * pool.tresca),
                 signed_percent(one.u), text("%.2f %%", 100 * one.tresca)});
  }
}

void write_membrane(std::ostream& out) {
  out << "\n## Cook's membrane, pooled volume\nnu = 0.4999, E = 240.565 MPa, small strain, "
         "shear 6.25 MPa: displacement [mm] at (48, 60). No reference: the rows converge.\n"
      << head({"cells", "pooled [mm]", "element [mm]"});
  for (Index cells : {8, 16, 32, 64}) {
    out << line({std::to_string(cells) + " x " + std::to_string(cells),
                 text("%.3f", incompressible_cook(pooled, cells)),
                 text("%.3f", incompressible_cook(element, cells))});
  }
}

void write_neo_hookean_membrane(std::ostream& out) {
  out << "\n## Cook's membrane, pooled volume, law neo-hookean\nThe same at finite deformation, in "
         "four "
         "steps of the load. By quadratic tetrahedra 6.97, by a prototype's patches of 8 elements "
         "6.75 and, refined, 6.85.\n"
      << head({"cells", "pooled [mm]", "element [mm]"});
  for (Index cells : {8, 16, 32}) {
    out << line({std::to_string(cells) + " x " + std::to_string(cells),
                 text("%.3f", neo_hookean_cook(pooled, cells, 4)),
                 text("%.3f", neo_hookean_cook(element, cells, 4))});
  }
}

void write_block(std::ostream& out) {
  out << "\n## Bonded block, pooled volume\n10 x 10 x 5 mm, E = 1 MPa, nu = 0.4999, between plates "
         "of which the upper comes down by 0.1 mm: its force [N]. By quadratic tetrahedra on a "
         "finer mesh "
         "3.45.\n"
      << head({"tetrahedra", "pooled [N]", "element [N]"});
  for (Index n : {6, 8, 12, 16}) {
    out << line({std::to_string(3 * n * n * n), text("%.2f", bonded_block_force(pooled, n)),
                 n <= 8 ? text("%.0f", bonded_block_force(element, n)) : "-"});
  }
}

}  // namespace

void write_pooled(std::ostream& out) {
  write_lame(out);
  write_membrane(out);
  write_neo_hookean_membrane(out);
  write_block(out);
}

}  // namespace sunder::test
