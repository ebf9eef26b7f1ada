// SPDX-License-Identifier: Apache-2.0
// Preset cracks without elements, whose faces are the mesh's own: nodes split along a surface, or a
// notch that belongs to the body's shape. Of a notch the walls and the root are the crack's faces,
// no outline, and how blunt it is decides whether a stress intensity factor describes it
// (method.md "Field K").
#pragma once

#include <vector>

#include "fracture/board.hpp"
#include "fracture/field_sif/free_surface.hpp"
#include "sunder/problem.hpp"

namespace sunder::fracture {

/// The mesh's own crack, seen from one of its tips.
struct Notch {
  int crack = kNone, tip = 0;
  bool closed = false;  ///< its faces lie on one another: split nodes; a crack like any other
  Vec2 root;            ///< where it ends, in the plane
  double width = 0;     ///< [mm] of the opening where its walls, prolonged, meet the root
  double angle = 0;     ///< [rad] between its walls
};

/// K of a notch is right within this share, or left out.
inline constexpr double kAccuracy = 0.03;

/// Radius of a domain that sees a slot as a crack, in its widths.
inline constexpr double kDomainOfWidths = 2.0;

/// By how much K of a slot is above that of a sharp crack which ends where the slot does, as a
/// share of it: far from its root a flat slot acts like a crack 0.3 times its width longer. `edge`:
/// the crack has one tip; a and b [mm] as in Eq. 3.
[[nodiscard]] double blunt_share(double width, double a, double b, bool edge);

/// By how much K of a V is below that of a sharp crack, as a share of it, seen by a domain of that
/// radius: between its walls the field at the root is less singular than a crack's, in shear much
/// less.
[[nodiscard]] double angle_share(const Notch& notch, double radius, double a, const Vec3& k);

/// Whether the notch is narrow enough for K of a sharp crack, whatever its angle brings on its
/// load.
[[nodiscard]] bool sharp_enough(const Notch& notch, double a, double b, bool edge);

/// All presets whose faces are the mesh's own, a record for each tip. The faces of those that are
/// open are marked as theirs.
[[nodiscard]] std::vector<Notch> find_notches(const Problem& problem, const Board& board,
                                              FreeSurface& surface);

}  // namespace sunder::fracture
