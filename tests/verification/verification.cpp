// SPDX-License-Identifier: Apache-2.0
// Writes docs/verification.md: every measured number beside the published one.
//   verification FILE
#include <exception>
#include <fstream>
#include <iostream>
#include <sstream>

#include "verification/sections.hpp"

namespace sunder::test {
namespace {

void write(std::ostream& out) {
  out << "# Verification\n\n"
         "Written by `verification docs/verification.md` (tests/verification, built with the "
         "tests and the program; some minutes, with CalculiX and gmsh installed). Every test run "
         "computes the cheaper numbers again and compares them with this page.\n\n"
         "Linear tetrahedra throughout. The boards with cracks: E = 5 MPa, nu = 0.3, one layer of "
         "cells of edge h, each six tetrahedra, cracks of destroyed elements (alpha = 1e-9) unless "
         "said otherwise, which end where their row ends. K by the interaction integral "
         "(`docs/method.md`, Field K), domain R = 6 h, shrunk to a where a centre crack has a < 6 "
         "h.\n";
  write_patch(out);
  write_cantilever(out);
  write_cook(out);
  write_pooled(out);
  write_peeling(out);
  write_calculix(out);
  write_strips(out, Notch::edge);
  write_strips(out, Notch::centre);
  write_remaining_stiffness(out);
  write_domains(out);
  write_energy(out);
  write_split(out);
  write_shaped(out);
  write_irregular(out);
  write_angled(out);
  write_grown(out);
  write_force_pairs(out);
  write_thickness(out);
  write_antiplane(out);
  write_growing(out);
#ifdef SUNDER_GMSH
  write_first_growth(out);
#endif
}

}  // namespace
}  // namespace sunder::test

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: verification FILE\n";
    return 2;
  }
  std::ostringstream page;
  try {
    sunder::test::write(page);
  } catch (const std::exception& e) {
    std::cerr << "verification: " << e.what() << "\n";
    return 1;
  }
  std::ofstream file(argv[1]);
  file << page.str();
  if (!file.flush()) {
    std::cerr << "cannot write " << argv[1] << "\n";
    return 3;
  }
  return 0;
}
