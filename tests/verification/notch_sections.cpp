// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/field_sif/published.hpp"
#include "core/field_sif/shaped_notch.hpp"
#include "verification/page.hpp"
#include "verification/sections.hpp"

namespace sunder::test {
namespace {

constexpr double kWidth = 20, kShare = 0.35;  // mm, a/W

/// A strip of n cells across and its notch, cells of 1 mm; the widths named are those of a strip
/// 20 mm wide.
struct Shaped {
  std::string name;
  int n;
  CrackedBody body;
};

int cells_of_notch(int n) { return static_cast<int>(std::lround(kShare * n)); }

std::vector<Shaped> shaped_notches() {
  std::vector<Shaped> all;
  for (int degrees : {10, 30, 45, 60, 75})
    for (int n : {20, 40, 80})
      all.push_back(
          {"V of " + std::to_string(degrees) + " deg", n, v_strip(n, cells_of_notch(n), degrees)});
  for (const auto& [n, rows] :
       {std::pair{80, 1}, std::pair{40, 1}, std::pair{80, 2}, std::pair{40, 2}, std::pair{80, 5}})
    all.push_back(
        {text("slot of %.2f mm", rows * kWidth / n), n, slotted_strip(n, cells_of_notch(n), rows)});
  return all;
}

}  // namespace

void write_shaped(std::ostream& out) {
  out << "\n## Notches of the mesh's shape\n\nEdge notches of a/W = .35 whose faces lie apart in "
         "the mesh, in a strip "
      << kWidth
      << " mm wide; K_I against Tada's of the sharp crack of that length. As the mesh gives it: "
         "the "
         "domain integral alone, over the domain that a run takes, and over one of radius 2 h:\n"
      << head({"notch", "mesh", "radius 2 h", "domain of a run", "K of a run", "field_note"});
  double worst = 0;
  for (Shaped& notch : shaped_notches()) {
    const double a = cells_of_notch(notch.n);
    const double published = tada_edge(a / notch.n) * std::sqrt(std::numbers::pi * a);
    const auto error = [&](const fracture::FieldIntensity& measured) {
      return measured.factors.k_1 / published;
    };
    const auto taken = notch.body.chosen_intensity(0);
    const bool empty = taken.disturbed.left_out;
    if (!empty) worst = std::max(worst, std::abs(error(taken) - 1));
    out << line({notch.name, "W/" + std::to_string(notch.n),
                 percent(error(notch.body.intensity(2))),
                 empty ? "" : percent(error(notch.body.intensity(taken.radius))),
                 empty ? "" : percent(error(taken)), std::string(taken.note())});
  }
  out << "\nLargest error of what is not left out: " << verdict(worst, 0.03) << ".\n";
}

}  // namespace sunder::test
