// SPDX-License-Identifier: Apache-2.0
// The vectors of the paper's Fig. 3 at crack tips: K_a e_a of the expansion, K_b d of the balanced
// pressure, K_c e_c of the one-sided pressure, and their sum v, along which the crack grew.
#pragma once

#include <string>
#include <vector>

#include "app/figure/canvas.hpp"
#include "app/figure/pose.hpp"
#include "app/output/state.hpp"

namespace sunder::app {

/// One vector of one tip; the sum comes after its parts.
struct TipVector {
  enum class Kind { expansion, balanced, one_sided, sum, field };
  Kind kind = Kind::sum;
  Vec2 root;  ///< where the tip was before its last growth, undeformed [mm]
  Vec2 k;     ///< in the plane, undeformed [MPa sqrt(mm)]
};

/// Of one tip's last growth; parts that are zero are left out. With K from the field there is one
/// vector: K along the direction of growth.
[[nodiscard]] std::vector<TipVector> tip_vectors(const SifTerms& terms, SifSource drives);

/// At every tip that has grown, in the directions of the undeformed board, at the place where the
/// picture draws that point; the longest K of the picture is a fixed share of the body's side.
[[nodiscard]] std::string draw_tip_vectors(const Problem& problem, const BoardPlane& plane,
                                           const Pose& pose, const State& state,
                                           const Canvas& canvas);

/// What the colours mean, in a line from `at` on [px]; empty when no tip has grown.
[[nodiscard]] std::string tip_vector_key(const Vec2& at, SifSource drives, bool any);

}  // namespace sunder::app
