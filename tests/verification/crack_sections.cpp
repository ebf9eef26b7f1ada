// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/field_sif/grown_cracks.hpp"
#include "core/field_sif/held_strip.hpp"
#include "core/field_sif/published.hpp"
#include "verification/page.hpp"
#include "verification/sections.hpp"

namespace sunder::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

void pull(CrackedBody& plate) {
  plate.load_uniform(0, 1, 0);
  plate.solve();
}

void inclined(std::ostream& out) {
  out << "\nAt an angle across the grid, 2a about 40 h; the reference is the angled crack's:\n"
      << head({"angle [deg]", "tip", "K_I, reference", "K_I, ours", "error", "K_II, reference",
               "K_II, ours", "K_II error"});
  double worst = 0;
  for (int degrees : {15, 30, 45, 60}) {
    auto plate = square_plate(28, 200);
    grow_inclined(plate, degrees, 20);
    pull(plate);
    const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
    const double scale = std::sqrt(std::numbers::pi * plate.crack().length / 2);
    for (int tip : {1, 0}) {
      const auto k = plate.intensity(kRing, tip).factors;
      const double k_1 = scale * c * c, k_2 = scale * s * c;
      worst = std::max({worst, std::abs(k.k_1 / k_1 - 1), std::abs(k.k_2 / k_2 - 1)});
      out << line({std::to_string(degrees), tip == 1 ? "first" : "second", text("%.4f", k_1),
                   text("%.4f", k.k_1), percent(k.k_1 / k_1), text("%.4f", k_2),
                   text("%.4f", k.k_2), percent(k.k_2 / k_2)});
    }
  }
  out << "\nLargest error: " << verdict(worst, 0.04) << ".\n";
}

void arcs(std::ostream& out) {
  out << "\nCircular arcs of radius 28 h under tension across the chord; reference: the exact "
         "solution in an infinite plane (Muskhelishvili; Cotterell and Rice 1980). Differences "
         "are given of sqrt(K_I^2 + K_II^2), the mean of the two tips:\n"
      << head({"half angle [deg]", "K_I, reference", "K_I, ours", "K_I difference",
               "K_II, reference", "K_II, ours", "K_II difference"});
  for (int degrees : {15, 30, 45}) {
    auto plate = square_plate(28 * std::sin(degrees * kDegree) + 8, 280);
    grow_arc(plate, 28, 28 * degrees * kDegree);
    pull(plate);
    const double half = plate.crack().length / 2 / 28;
    const ArcIntensity reference = arc_intensity(28, half);
    const auto left = plate.intensity(kRing, 1).factors, right = plate.intensity(kRing, 0).factors;
    const double k_1 = (left.k_1 + right.k_1) / 2;
    const double k_2 = (std::abs(left.k_2) + std::abs(right.k_2)) / 2;
    const double all = std::hypot(reference.k_1, reference.k_2);
    out << line({text("%.1f", half / kDegree), text("%.4f", reference.k_1), text("%.4f", k_1),
                 percent(1 + (k_1 - reference.k_1) / all), text("%.4f", reference.k_2),
                 text("%.4f", k_2), percent(1 + (k_2 - reference.k_2) / all)});
  }
}

void kinks(std::ostream& out) {
  out << "\nA crack of 20 h with a branch of 7 to 17 h at an angle. Reference: sqrt(E dU/dL / t) "
         "between the shortest and the longest branch; ours: sqrt(K_I^2 + K_II^2), root mean "
         "square over three branches. A ragged end makes the energy's length uncertain by 5 %:\n"
      << head({"angle [deg]", "K, energy", "K, integral", "difference"});
  for (int degrees : {30, 45, 60}) {
    double energy[3], length[3], squares = 0;
    for (int i = 0; i < 3; ++i) {
      auto plate = square_plate(30, 200);
      grow_kinked(plate, 10, degrees, 7 + 5 * i);
      pull(plate);
      const auto k = plate.intensity(kRing).factors;
      energy[i] = plate.energy();
      length[i] = plate.crack().length;
      squares += (k.k_1 * k.k_1 + k.k_2 * k.k_2) / 3;
    }
    const double release = std::sqrt(5 * (energy[2] - energy[0]) / (length[2] - length[0]));
    out << line({std::to_string(degrees), text("%.4f", release), text("%.4f", std::sqrt(squares)),
                 percent(std::sqrt(squares) / release)});
  }
}

}  // namespace

Intensity angled_intensity(int degrees) {
  const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
  auto board = wide_plate(10, 1.0);
  board.load_uniform(s * s, c * c, s * c);
  board.solve();
  const auto k = board.intensity(kRing).factors;
  return {k.k_1, k.k_2};
}

void write_angled(std::ostream& out) {
  out << "\n## Angled crack in tension\nK_I = s sqrt(pi a) cos^2 b, K_II = s sqrt(pi a) sin b cos "
         "b in an infinite plate; 2a = 21 h in a plate of 20 a, the load turned by b instead of "
         "the crack. A plate of 20 a instead of an infinite one adds 0.6 %.\n"
      << head({"b [deg]", "K_I, reference", "K_I, ours", "error", "K_II, reference", "K_II, ours",
               "K_II error"});
  double worst = 0;
  const double scale = std::sqrt(std::numbers::pi * 10.5);
  for (int degrees : {0, 15, 30, 45, 60, 75}) {
    const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
    const Intensity k = angled_intensity(degrees);
    const double k_1 = scale * c * c, k_2 = scale * s * c;
    worst = std::max(worst, std::abs(k.k_1 / k_1 - 1));
    if (degrees > 0) worst = std::max(worst, std::abs(k.k_2 / k_2 - 1));
    out << line({std::to_string(degrees), text("%.4f", k_1), text("%.4f", k.k_1),
                 percent(k.k_1 / k_1), text("%.4f", k_2), text("%.4f", k.k_2),
                 degrees > 0 ? percent(k.k_2 / k_2) : "-"})
        << std::flush;
  }
  out << "\nLargest error: " << verdict(worst, 0.04) << ".\n";
}

void write_grown(std::ostream& out) {
  out << "\n## Staircases, curves and kinks\nCracks grown across the grid's lines by rule 10 of "
         "`docs/method.md`: ragged rows of tetrahedra whose path is all that the integral knows.\n";
  inclined(out);
  arcs(out);
  kinks(out);
}

double force_pair_intensity(double b) {
  const double h = 0.375;
  auto board = wide_plate(32, h);
  board.load_pair(b, 1);
  board.load_pair(-b, 1);
  board.solve();
  return board.intensity(kRing * h).factors.k_1;
}

void write_force_pairs(std::ostream& out) {
  const double h = 0.375, a = 12 + h / 2;
  out << "\n## Pairs of forces on the faces\nHalf length a = 12.1875 mm, h = 0.375 mm, P = 1 N/mm "
         "at +-b; K_I = 2 P sqrt(a/pi)/sqrt(a^2 - b^2) in an infinite plate (ours: 20 a wide).\n"
      << head({"b [mm]", "from the tip", "K_I, reference", "K_I, ours", "error"});
  double worst = 0;
  for (double b : {0.1875, 6.1875, 9.1875, 10.6875}) {
    const double reference = force_pair(1, a, b), k = force_pair_intensity(b);
    if (a - b >= 10 * h) worst = std::max(worst, std::abs(k / reference - 1));
    out << line({text("%.4f", b), text("%.0f h", (a - b) / h), text("%.4f", reference),
                 text("%.4f", k), percent(k / reference)})
        << std::flush;
  }
  out << "\nLargest error with the forces 10 h or more from the tip: " << verdict(worst, 0.03)
      << ".\n";
}

void write_thickness(std::ostream& out) {
  out << "\n## Thickness\nEdge notch, a/W = 0.5, h = W/20. Forces alone decide K in the plane, so "
         "the reference is Tada's, times 1/sqrt(1 - nu^2) where a free block is so thick that the "
         "ring sees plane strain at the front (G is the same, K = sqrt(E' G)). Held flat: u_z = 0 "
         "everywhere.\n"
      << head({"body", "E'", "K_I, reference", "K_I, ours", "error", "K, energy",
               "integral against energy"});
  for (int layers : {1, 4, 8, 16}) {
    for (bool flat : {false, true}) {
      if (flat && layers > 4) continue;
      auto board = thick_strip(20, 0.5, layers, flat);
      pull(board);
      const auto measured = board.intensity(kRing);
      const double c = measured.material.constraint;
      const double plane = published_intensity(Notch::edge, 20, 0.5);
      const double reference = c > 0 && !flat ? plane / std::sqrt(1 - 0.09) : plane;
      const double release = flat ? 0 : energy_release_intensity(Notch::edge, 20, 0.5, layers, c);
      const double k = measured.factors.k_1;
      out << line({std::to_string(layers) + (layers > 1 ? " layers" : " layer") +
                       (flat ? ", held flat" : ""),
                   c > 0 ? "E/(1 - nu^2)" : "E", text("%.3f", reference), text("%.3f", k),
                   percent(k / reference), flat ? "-" : text("%.3f", release),
                   flat ? "-" : percent(k / release)})
          << std::flush;
    }
  }
}

double antiplane_factor(int n, double share) {
  auto board = antiplane_strip(n, share);
  const double a = n * share;
  return std::abs(board.intensity(kRing).factors.k_3) / std::sqrt(std::numbers::pi * a);
}

void write_antiplane(std::ostream& out) {
  out << "\n## Edge crack under antiplane shear, K_III\nStrip held in its plane, sheared along its "
         "thickness. Reference: F = sqrt(2/(pi x) tan(pi x/2)), x = a/W, exact (Tada).\n"
      << head({"a/W", "reference", "W/20", "error W/20", "W/40", "error W/40"});
  for (double share : {0.2, 0.4, 0.6}) {
    const double reference = antiplane_edge(share);
    const double coarse = antiplane_factor(20, share), fine = antiplane_factor(40, share);
    out << line({text("%.1f", share), text("%.4f", reference), text("%.4f", coarse),
                 percent(coarse / reference), text("%.4f", fine), percent(fine / reference)});
  }
}

void write_growing(std::ostream& out) {
  const HeldStrip strip;
  out << "\n## Along a growing crack: formula and field\nBoard 20 x 21 x 1 mm, E = 5 MPa, nu = "
         "0.3, h = 1 mm, edge notch of 6 mm, lower end fixed, upper end moved; model B with sif = "
         "\"field\". Between held ends K does not depend on the crack's length (Rice 1967): "
         "K = E u/H sqrt(H/2/(1 - nu^2)). The formula's F(a/b) is that of free ends.\n"
      << head({"a [mm]", "K, formula", "K_I, field", "K, Rice", "field against Rice", "K_II/K_I"});
  double last = -1;
  for (const DestroyedElement& row : strip.tear(SifSource::field, {0, 8, 0}).rows) {
    if (!row.sif || row.sif->a == last) continue;
    last = row.sif->a;
    const double rice = strip.rice(8 * row.load_factor);
    out << line({text("%.2f", row.sif->a), text("%.3f", *row.sif->k_formula),
                 text("%.3f", *row.sif->k_1), text("%.3f", rice), percent(*row.sif->k_1 / rice),
                 text("%+.2f %%", 100 * *row.sif->k_2 / *row.sif->k_1)});
  }
}

}  // namespace sunder::test
