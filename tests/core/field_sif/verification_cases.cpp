// SPDX-License-Identifier: Apache-2.0
#include "core/field_sif/verification_cases.hpp"

#include <cmath>
#include <numbers>

#include "core/field_sif/published.hpp"

namespace sunder::test {
namespace {

CrackedBoard strip(Notch notch, int n, int cells, CrackedBoardOptions options, int layers = 1) {
  options.mirror_left = notch == Notch::centre;
  GridLines lines{even_lines(n, 1.0), graded_lines(1.0, n / 2.0, 3.0 * n, 1.1),
                  even_lines(layers, 1.0)};
  // Split nodes need a grid line where deleted elements need a row of cells.
  const double y = options.made == CrackMade::split ? 0.5 : 0.0;
  return CrackedBoard(lines, 0, cells, y, options);
}

int crack_cells(int n, double share) { return static_cast<int>(std::lround(share * n)); }

}  // namespace

CrackedBoard notched_strip(Notch notch, int n, double share, const CrackedBoardOptions& options) {
  return strip(notch, n, crack_cells(n, share), options);
}

double published_intensity(Notch notch, int n, double share) {
  const double a = crack_cells(n, share);
  const double factor = notch == Notch::edge ? tada_edge(a / n) : tada_centre(a / n);
  return factor * std::sqrt(std::numbers::pi * a);
}

double energy_release_intensity(Notch notch, int n, double share, int layers, double constraint) {
  const CrackedBoardOptions options;
  double energy[2];
  for (int k = 0; k < 2; ++k) {
    CrackedBoard board = strip(notch, n, crack_cells(n, share) + 2 * k - 1, options, layers);
    board.load_uniform(0, 1, 0);
    board.solve();
    energy[k] = board.energy();
  }
  // Under a fixed load the strain energy grows by what the crack takes: G t da = dU.
  const double release = (energy[1] - energy[0]) / (2.0 * layers);
  const fracture::TipMaterial material{options.young, options.poisson, constraint};
  return std::sqrt(material.effective_young() * release);
}

CrackedBoard antiplane_strip(int n, double share) {
  CrackedBoardOptions options;
  options.held_in_plane = true;
  CrackedBoard board = strip(Notch::edge, n, crack_cells(n, share), options);
  board.load_antiplane(1);
  board.solve();
  return board;
}

CrackedBoard thick_strip(int n, double share, int layers, bool held_flat) {
  CrackedBoardOptions options;
  options.held_flat = held_flat;
  return strip(Notch::edge, n, crack_cells(n, share), options, layers);
}

CrackedBoard wide_plate(int cells, double h, const CrackedBoardOptions& options) {
  const double a = cells * h, half = 10 * a;
  GridLines lines{graded_lines(h, a + 12 * h, half, 1.15), graded_lines(h, 12 * h, half, 1.15),
                  even_lines(1, h)};
  return CrackedBoard(lines, -a - h / 2, a + h / 2, 0, options);
}

}  // namespace sunder::test
