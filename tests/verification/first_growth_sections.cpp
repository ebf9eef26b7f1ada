// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "verification/first_growth.hpp"
#include "verification/page.hpp"
#include "verification/sections.hpp"

namespace sunder::test {
namespace {

constexpr double kTarget = 0.02;

/// Largest difference between two of them over the smallest.
double spread(const std::vector<double>& forces) {
  const auto [least, most] = std::minmax_element(forces.begin(), forces.end());
  return *most / *least - 1;
}

void write_notched(std::ostream& out) {
  out << "\nAn edge notch of 10 mm, one element high, law linear, K by the field: the grip's force "
         "at first growth by K_c = 1 MPa sqrt(mm), and by Eq. 1 with a yield stress of 2 MPa.\n"
      << head({"tetrahedra", "h [mm]", "force by K_c [N]", "force by Eq. 1 [N]"});
  std::vector<double> forces;
  for (const double size : kBoardSizes) {
    const NotchedBoard board = notched_board(size);
    forces.push_back(board.force);
    out << line({std::to_string(board.tets), text("%.3f", board.h), text("%.4f", board.force),
                 text("%.3f", board.force_by_eq1)})
        << std::flush;
  }
  out << "\nLargest difference by K_c: " << verdict(spread(forces), kTarget) << ".\n";
}

/// The crack of split faces, beyond its first growth.
void write_torn_on(std::ostream& out) {
  out << "\nThe same notch torn on by a crack that splits (`crack = \"split\"`), the upper end "
         "moved "
         "up and .3 times as far across: the grip's force that keeps it growing by K_c, and where "
         "its tip is, at each x that the tip has come to:\n"
      << head({"tetrahedra", "h [mm]", "what", "x = 12", "14", "16", "18", "20 mm"});
  std::vector<GrownBoard> boards;
  for (const double size : kBoardSizes) {
    boards.push_back(grown_board(size));
    const GrownBoard& board = boards.back();
    for (const bool force : {true, false}) {
      std::vector<std::string> cells{std::to_string(board.tets), text("%.3f", board.h),
                                     force ? "force [N]" : "y [mm]"};
      for (const double value : force ? board.force : board.y) cells.push_back(text("%.3f", value));
      out << line(cells) << std::flush;
    }
  }
  double most = 0, apart = 0;
  for (std::size_t i = 0; i < std::size(kGrownTo); ++i) {
    std::vector<double> forces;
    for (const GrownBoard& board : boards) forces.push_back(board.force[i]);
    most = std::max(most, spread(forces));
    for (const GrownBoard& a : boards) {
      for (const GrownBoard& b : boards) {
        apart = std::max(apart, std::abs(a.y[i] - b.y[i]) / std::max(a.h, b.h));
      }
    }
  }
  out << "\nLargest difference of the forces: " << verdict(most, 0.03)
      << "; of the paths in the larger h: " << verdict(apart, 1) << ".\n";
}

void write_paper(std::ostream& out) {
  out << "\nThe paper's notched board (scenes/notch-b.toml) in three element sizes, K_c = 1 MPa "
         "sqrt(mm) in all its tissues, pulled at its corner. Its notch of 4.04 mm is a wedge that "
         "ends in a point, on the border of two tissues: linear elements hold a point too stiffly "
         "(\"Notches of the mesh's shape\"), so K is low by what falls with h. The last column is "
         "a "
         "notch of that length one element high, in the board above:\n"
      << head({"tetrahedra", "force by K_c [N]", "force by Eq. 1 [N]", "even notch, by K_c [N]"});
  std::vector<double> forces, even;
  for (const double size : kPaperSizes) {
    const PaperBoard board = paper_board(size);
    forces.push_back(board.force);
    // h of the paper's meshes is .68 of the size that gmsh is told.
    even.push_back(notched_board(0.68 * size, kPaperNotch).force);
    out << line({std::to_string(board.tets), text("%.3f", board.force),
                 text("%.2f", board.force_by_eq1), text("%.3f", even.back())})
        << std::flush;
  }
  out << "\nLargest difference by K_c: of the wedge " << text("%.2f %%", 100 * spread(forces))
      << ", of the even notch " << verdict(spread(even), kTarget) << ".\n";
}

void write_turned(std::ostream& out) {
  out << "\nThe same board, law corotated, turned by 30 deg as a whole and then pulled along until "
         "J "
         "= G_c = 2 N/mm, beyond small strain round the tip:\n"
      << head(
             {"tetrahedra", "force [N]", "extension [mm]", "largest rotation [deg]", "field_note"});
  std::vector<double> forces;
  for (const double size : kBoardSizes) {
    const TurnedBoard board = turned_board(size);
    forces.push_back(board.force);
    out << line({std::to_string(board.tets), text("%.3f", board.force),
                 text("%.4f", board.extension), text("%.1f", board.rotation),
                 board.strain ? "strain" : ""})
        << std::flush;
  }
  out << "\nLargest difference of the forces: " << verdict(spread(forces), kTarget) << ".\n";
}

void write_holed(std::ostream& out) {
  out << "\nA round hole of 10 mm in place of the notch, ends that slide across: the grip's force "
         "at first "
         "rupture (maximum shear stress, yield 2 MPa), with `averaging` of R = 3 mm and by "
         "element:\n"
      << head({"tetrahedra", "size at the hole [mm]", "force, averaging 3 mm [N]",
               "force by element [N]"});
  std::vector<double> forces;
  for (const double size : kHoleSizes) {
    const HoledBoard board = holed_board(size);
    if (3 * size <= kBoardAveraging) forces.push_back(board.force);
    out << line({std::to_string(board.tets), text("%.1f", size), text("%.2f", board.force),
                 text("%.2f", board.force_by_element)})
        << std::flush;
  }
  out << "\nLargest difference with averaging where R spans three elements or more: "
      << verdict(spread(forces), kTarget) << ".\n";
}

}  // namespace

void write_first_growth(std::ostream& out) {
  out << "\n## First growth\nUnstructured meshes of gmsh of one board, 50 x 50 x 2 mm, E = 5 MPa, "
         "nu "
         "= .4, its lower end held, its upper end moved by a grip (`docs/method.md` "
         "\"Toughness\").\n";
  write_notched(out);
  write_torn_on(out);
  write_paper(out);
  write_turned(out);
  write_holed(out);
}

}  // namespace sunder::test
