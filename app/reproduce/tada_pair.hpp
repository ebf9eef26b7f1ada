// SPDX-License-Identifier: Apache-2.0
// K of a pair of forces that press the faces of an edge crack in a strip apart.
#pragma once

namespace sunder::app::reproduce {

/// sqrt(mm) in K = P * this, P: force per thickness on each face [N/mm]; `distance` from the tip,
/// crack length and width of the strip [mm]. Tada, Paris and Irwin, The Stress Analysis of Cracks
/// Handbook: one body, straight crack, strip free to bend.
[[nodiscard]] double tada_pair(double distance, double length, double width);

/// Distance over length at which it is least: nearer to the tip K grows with nearness, farther
/// from it with distance.
[[nodiscard]] double tada_turn(double length, double width);

}  // namespace sunder::app::reproduce
