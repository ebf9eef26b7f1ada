// SPDX-License-Identifier: Apache-2.0
// Strips with an edge notch that belongs to the mesh's shape: its preset has no elements. Unit load
// at top and bottom; cells of 1 mm round the notch, rows grow beyond.
#pragma once

#include <functional>

#include "core/field_sif/cracked_body.hpp"

namespace sunder::test {

/// The scene without the elements whose centroid is in `hole`, and without the nodes that only they
/// used. Selections by id follow.
[[nodiscard]] Scene cut_out(Scene scene, const std::function<bool(const Vec3&)>& hole);

/// A slot of `rows` rows and `cells` cells with a flat end, in a strip `n` cells wide.
[[nodiscard]] CrackedBody slotted_strip(int n, int cells, int rows);

/// A crack of split nodes whose faces were moved apart by `half` [mm] each, of the distance behind
/// the tip; 0 leaves it closed.
[[nodiscard]] CrackedBody opened_strip(int n, int cells, const std::function<double(double)>& half);

/// V of that many degrees.
[[nodiscard]] CrackedBody v_strip(int n, int cells, double degrees);

/// Half a V of that many degrees at each end of an internal notch of length 2a, a = `cells` mm, in
/// a plate 20 a wide; cells of 1 mm grow with the distance. Not loaded.
[[nodiscard]] CrackedBody opened_plate(int cells, double degrees);

}  // namespace sunder::test
