// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "verification/page.hpp"
#include "verification/peeling_cases.hpp"
#include "verification/sections.hpp"

namespace sunder::test {

void write_peeling(std::ostream& out) {
  out << "\n## Peeling\n"
         "Interfaces (`docs/method.md` \"Interfaces\") on structured meshes one cell wide, plane "
         "strain, law neo-hookean: strips of aortic media, .6 mm, E = 0.5 MPa, nu = 0.45, "
         "interface "
         "0.14 MPa and G_c = 0.0458 N/mm (Sommer et al. 2008), from a rigid bed and, as a T, from "
         "each other; and two arms of 2 mm, E = 100 MPa, nu = 0.3, interface 0.2 MPa and 0.01 "
         "N/mm. "
         "Four steps of the grip while the edge moves on by a cell, of .3 mm and .5 mm on the "
         "coarsest meshes.\n\n"
         "Over the steady part: force per width at the ends of steps over theory, its mean, least "
         "and largest (before a row parts); the grip's work less the stored energy, and the energy "
         "of the parted pairs, over G_c times the area parted. Theory: force N per width and "
         "stretch s with G_c = N (s - cos angle) - W(s), in a T-peel half of G_c an arm; in "
         "brackets the mean over that of rigid strips, G_c / (1 - cos angle). Of the double "
         "cantilever: beams on the interface's springs, G = P^2 (a + l)^2 / (B^2 E' I), l^4 = 2 E' "
         "I / k.\n"
      << head({"case", "cells [mm]", "tetrahedra", "mean", "(rigid)", "least", "largest", "work",
               "parted"});
  double force = 0, work = 0;
  for (const Peel peel : kPeels) {
    for (const Index finer : {1, 2, 4}) {
      const PeelFigures of = test::peel(peel, finer);
      out << line({name_of(peel), text("%g", coarse_cell(peel) / finer), std::to_string(of.tets),
                   text("%.3f", of.mean),
                   peel == Peel::double_cantilever ? "" : text("(%.3f)", of.over_rigid),
                   text("%.3f", of.least), text("%.3f", of.largest), text("%.3f", of.work),
                   text("%.3f", of.parted)});
      if (finer < 4) continue;
      force = std::max(force, std::abs(of.mean - 1));
      work = std::max(work, std::abs(of.work - 1));
    }
  }
  out << "\nOn the finest meshes, largest error of the mean " << verdict(force, 0.05)
      << ", of the work " << verdict(work, 0.02)
      << ".\n\nA row's energy is that of the law, so `parted` tells that areas and modes add up, "
         "and "
         "`work` what was spent. Work is more than G_c asks for because a row of nodes parts at "
         "the end of a step, "
         "beyond the force at which it would, and then all at once; it falls with the cell and "
         "with "
         "the step (`bench_peeling`). Arms four cells high are too stiff in bending by a fifth, "
         "as the cantilever above, so the double cantilever's force is 10 % high there.\n";
}

}  // namespace sunder::test
