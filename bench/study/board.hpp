// SPDX-License-Identifier: Apache-2.0
// The board of the stability study, with one knob per difficulty.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::bench {

/// What makes a cell of the study hard. The defaults are an easy board.
struct Difficulty {
  double contrast = 100;  ///< E of the frames over E of the upper half
  double poisson = 0.4;   ///< of all materials
  double sliver = 1;      ///< height over longest edge of the worst element; 1: mesh as it is
  double alpha = 1e-6;    ///< remaining share of a destroyed element's stiffness
  double unit = 1;        ///< lengths in units of this many mm; forces follow so that strain stays
  std::string pattern = "crack";  ///< scattered, crack, cut, island, bridge
  int fractures = 10;             ///< scattered, crack; the others have their own number
  int layers = 1;                 ///< of cells through the thickness
  bool pooled = false;            ///< volume pooled over patches, in all materials
};

struct DifficultBoard {
  std::shared_ptr<const Problem> problem;  ///< solver options at their defaults
  std::vector<double> force;               ///< nodal, shape (3 * nodes)
  std::vector<Index> removed;              ///< elements in the order of their fracture
};

/// 10 x 10 cells a layer, of six tetrahedra each, 50 x 50 x 5 mm, held at the top, pulled at the
/// lower right; for patterns that cut, a second pull acts on what stays attached. Throws
/// std::invalid_argument for an unknown pattern or a sliver that no vertex can give.
[[nodiscard]] DifficultBoard difficult_board(const Difficulty& difficulty);

}  // namespace sunder::bench
