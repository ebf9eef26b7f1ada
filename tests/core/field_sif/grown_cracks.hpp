// SPDX-License-Identifier: Apache-2.0
// Cracks that leave the grid's lines: grown through the elements by rule 10 of method.md, they are
// staircases of tetrahedra.
#pragma once

#include "core/field_sif/cracked_body.hpp"

namespace sunder::test {

/// A square plate, graded, fine within `fine` mm of its middle with cells of 1 mm; one layer.
[[nodiscard]] CrackedBody square_plate(double fine, double half);

/// Internal crack through the middle at `degrees` to x, both tips grown by `half_length`.
void grow_inclined(CrackedBody& plate, double degrees, double half_length);

/// As grow_inclined at 0 degrees, then the last tip goes on at `degrees` by `branch`.
void grow_kinked(CrackedBody& plate, double half_length, double degrees, double branch);

/// Internal crack along a circle of radius R above its centre, by `arc` to both sides of the top.
void grow_arc(CrackedBody& plate, double radius, double arc);

/// Circular arc of half angle a under tension s across its chord, in an infinite plane
/// (Muskhelishvili; Cotterell and Rice 1980): K_I and |K_II| over s.
struct ArcIntensity {
  double k_1 = 0, k_2 = 0;
};
[[nodiscard]] ArcIntensity arc_intensity(double radius, double half_angle);

}  // namespace sunder::test
