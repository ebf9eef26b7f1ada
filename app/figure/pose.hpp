// SPDX-License-Identifier: Apache-2.0
// Where a picture draws each node: deformed at true scale, magnified or reduced where that would
// show nothing, and with what no longer hangs on anything drawn near its place.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/output/state.hpp"
#include "sunder/board_plane.hpp"

namespace sunder::app {

struct Pose {
  std::vector<Vec3> position;  ///< per node of mesh_of(), mm, displacement times `scale`
  std::vector<Vec3> shift;     ///< position minus undeformed
  double scale = 1;            ///< of displacements
  bool loose_piece = false;    ///< a piece is cut off: it is drawn as a rigid body near its place
};

/// Nodes that only destroyed elements hold follow their neighbours; their own displacement means
/// nothing (their stiffness is alpha times the tissue's). Lips of split cracks lie on their ideal
/// paths before they move. `scale`: of displacements, in place of what shows them well.
[[nodiscard]] Pose pose_of(const Problem& problem, const BoardPlane& plane, const State& state,
                           std::optional<double> scale = {});

}  // namespace sunder::app
