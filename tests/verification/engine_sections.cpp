// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "verification/calculix.hpp"
#include "verification/engine_cases.hpp"
#include "verification/page.hpp"
#include "verification/sections.hpp"

namespace sunder::test {
namespace {

std::string under(double error, double bound) {
  return (error <= bound ? "under " : "**over** ") + text("%.0e", bound);
}

std::string deviation(double value, double reference) {
  return text("%+.1f %%", 100 * (value / reference - 1));
}

void twin_row(std::ostream& out, const std::string& name, const Twin& twin) {
  out << line({name, text("%.6f", twin.calculix), text("%.6f", twin.ours),
               under(std::abs(twin.ours / twin.calculix - 1), 1e-6)});
}

}  // namespace

void write_patch(std::ostream& out) {
  out << "\n## Patch test\n192 distorted tetrahedra (4 x 4 x 2 cells, inner nodes shifted by up to "
         "a quarter cell), E = 5 MPa, nu = 0.4, each of the six states of constant strain 0.01. "
         "Reference: exact (linear elements reproduce it); errors are relative.\n"
      << head({"surface", "strains", "displacement", "stress", "residual"});
  for (PatchHeld held : {PatchHeld::surface, PatchHeld::three_nodes}) {
    PatchErrors worst;
    for (int component = 0; component < 6; ++component) {
      const PatchErrors e = patch_errors(component, held);
      worst.u = std::max(worst.u, e.u);
      worst.stress = std::max(worst.stress, e.stress);
      worst.residual = std::max(worst.residual, e.residual);
    }
    out << line({held == PatchHeld::surface ? "displaced" : "loaded, held at three nodes", "6",
                 under(worst.u, 1e-12), under(worst.stress, 1e-12), under(worst.residual, 1e-12)});
  }
}

void write_cantilever(std::ostream& out) {
  out << "\n## Cantilever\n10 x 1 x 1 mm, E = 5 MPa, nu = 0, end traction 1e-3 MPa along y; mean "
         "deflection of the end. Reference: Timoshenko, shear factor 5/6, 0.8048 mm. Linear "
         "tetrahedra are stiff in bending: the expected deviations are those published for correct "
         "ones.\n"
      << head({"tetrahedra", "reference [mm]", "ours [mm]", "error", "expected", "order"});
  const std::pair<Index, double> expected[] = {{2, -45}, {4, -17.6}, {6, -8.7}};
  double last = 0, last_cells = 0;
  for (const auto& [cells, percent_] : expected) {
    const double v = mean_end_deflection(cells, 1), error = 1 - v / kTimoshenko;
    out << line(
        {std::to_string(60 * cells * cells * cells), text("%.4f", kTimoshenko), text("%.4f", v),
         deviation(v, kTimoshenko), text("%+.1f %%", percent_),
         last > 0 ? text("%.1f", std::log(last / error) / std::log(cells / last_cells)) : "-"});
    last = error;
    last_cells = cells;
  }
}

void write_cook(std::ostream& out) {
  for (Plane plane : {Plane::strain, Plane::stress}) {
    const bool strain = plane == Plane::strain;
    const double reference = cook_published(plane);
    out << "\n## Cook's membrane, plane " << (strain ? "strain" : "stress")
        << "\nCook 1974; one layer of cells. "
        << (strain ? "E = 70 MPa, nu = 1/3, shear 6.25 MPa on the right; vertical displacement at "
                     "(48, 60), 32.27 mm."
                   : "E = 1 MPa, nu = 1/3, shear force 1 N/mm on the right; vertical displacement "
                     "at (48, 52), 23.96 mm.")
        << " The expected deviations are those published for correct linear elements.\n"
        << head({"cells", "reference [mm]", "ours [mm]", "error", "expected"});
    std::vector<std::pair<Index, double>> expected{{16, -11.5}, {32, -3.3}, {64, -0.9}};
    if (strain) expected = {{16, -13.4}, {32, -4.8}, {64, -1.7}, {96, -0.9}};
    for (const auto& [cells, percent_] : expected) {
      const double v = cook_deflection(plane, cells);
      out << line({std::to_string(cells) + " x " + std::to_string(cells), text("%.2f", reference),
                   text("%.3f", v), deviation(v, reference), text("%+.1f %%", percent_)})
          << std::flush;
    }
  }
}

void write_calculix(std::ostream& out) {
  if (!calculix_installed())
    throw std::runtime_error("the page needs the program ccx: apt-get install calculix-ccx");
  out << "\n## CalculiX on the same meshes\nAn independent program (ccx, element C3D4) on the same "
         "nodes, elements and loads. It prints seven digits, so agreement is better than 1e-6.\n"
      << head({"case", "CalculiX [mm]", "ours [mm]", "difference"});
  twin_row(out, "cantilever, 480 tetrahedra, end", cantilever_twin(2));
  twin_row(out, "Cook, plane strain, 32 x 32, (48, 60)", cook_twin(Plane::strain, 32));
  twin_row(out, "Cook, plane stress, 32 x 32, (48, 52)", cook_twin(Plane::stress, 32));
  out << "\nThe board of the paper (1954 tetrahedra, 500 MPa beside 5 MPa), pulled at its corner; "
         "2-norm of all displacements, largest stress difference over largest stress:\n"
      << head({"fractures along a crack", "displacement", "stress"});
  for (std::size_t fractures : {0u, 32u}) {
    const TwinErrors e = board_twin(fractures, Route::inverse);
    out << line({std::to_string(fractures), under(e.u, 1e-6), under(e.stress, 1e-6)});
  }
}

}  // namespace sunder::test
