// SPDX-License-Identifier: Apache-2.0
// A crack of split linear tetrahedra behaves as one that is shorter (method.md "Split cracks").
#pragma once

#include "fracture/board.hpp"
#include "sunder/crack.hpp"
#include "sunder/scene.hpp"

namespace sunder::fracture {

/// By how much [mm], for the layers of elements through the thickness and the tissue at the tip.
[[nodiscard]] double tip_offset(const Board& board, const Material& tissue);
/// A crack whose tip is at its front, as its field shows it: with one tip so much further back.
[[nodiscard]] Crack as_its_field_shows(const Crack& crack, std::size_t tip, const Board& board,
                                       const Material& tissue);

}  // namespace sunder::fracture
