// SPDX-License-Identifier: Apache-2.0
// Loads at which a crack starts to grow, or tissue to break, on unstructured meshes of one board:
// 50 x 50 x 2 mm, E = 5 MPa, nu = .4, its lower end held and its upper end moved by a grip.
#pragma once

#include "verification/gmsh_strip.hpp"

namespace sunder::test {

/// Element sizes [mm] of 4, 18 and 70 thousand tetrahedra.
inline constexpr double kBoardSizes[] = {2.3, 1.15, 0.72};
/// Of boards with a hole, beside it; the last three are at most a third of kBoardAveraging.
inline constexpr double kHoleSizes[] = {2, 1, 0.7, 0.5};

/// What the tables hold K, J and strength against.
inline constexpr double kBoardToughness = 1;  ///< K_c [MPa sqrt(mm)]
inline constexpr double kBoardEnergy = 2;     ///< G_c [N/mm]
inline constexpr double kBoardYield = 2;      ///< [MPa]
inline constexpr double kBoardAveraging = 3;  ///< [mm]

/// An edge notch, `notch` mm long, a volume one element high that is taken out.
struct NotchedBoard {
  Index tets = 0;
  double h = 0;             ///< mean projected edge [mm]
  double force = 0;         ///< of the grip when K = kBoardToughness, law linear [N]
  double force_by_eq1 = 0;  ///< when Eq. 1's reach at kBoardYield passes the first element
};
[[nodiscard]] NotchedBoard notched_board(double size, double notch = 10);

/// The same, law corotated, turned by 30 deg as a whole and then pulled along until J is
/// kBoardEnergy.
struct TurnedBoard {
  Index tets = 0;
  double force = 0;      ///< along the board [N]
  double extension = 0;  ///< [mm]
  double rotation = 0;   ///< largest of an element [deg]
  bool strain = false;   ///< beyond small strain round the tip
};
[[nodiscard]] TurnedBoard turned_board(double size);

/// The notched board torn on by a crack that splits, its upper end moved up and across: the grip's
/// force that keeps the crack growing, K = kBoardToughness, and where its tip is, by how far the
/// tip has come.
inline constexpr double kGrownTo[] = {12, 14, 16, 18, 20};  ///< x of the tip [mm]
struct GrownBoard {
  Index tets = 0;
  double h = 0;                  ///< mean projected edge [mm]
  std::vector<double> force, y;  ///< [N], of the tip [mm]; at each of kGrownTo
};
[[nodiscard]] GrownBoard grown_board(double size);

/// The paper's notched board (scenes/notch-b.toml) in other element sizes, with K_c in all its
/// tissues: the force at its corner when K = kBoardToughness.
inline constexpr double kPaperSizes[] = {3.939, 2, 1.2};
inline constexpr double kPaperNotch = 4.04;  ///< its length [mm]
struct PaperBoard {
  Index tets = 0;
  double force = 0;  ///< [N]
  double force_by_eq1 = 0;
};
[[nodiscard]] PaperBoard paper_board(double size);

/// A hole of 10 mm in the middle and no notch, the ends on rollers: first rupture by the maximum
/// shear stress.
struct HoledBoard {
  Index tets = 0;
  double force = 0;             ///< of the grip [N], `averaging` kBoardAveraging
  double force_by_element = 0;  ///< without
};
[[nodiscard]] HoledBoard holed_board(double size);

}  // namespace sunder::test
