// SPDX-License-Identifier: Apache-2.0
// On which nodes an instrument presses a crack's face (method.md 7).
#pragma once

#include <cstdint>
#include <span>

#include "fracture/board.hpp"
#include "fracture/criterion.hpp"
#include "sunder/crack.hpp"
#include "sunder/scene.hpp"

namespace sunder::fracture {

/// The nodes of that face nearest to press.at: one on the board's bottom surface and one on its
/// top surface; a single one, nearest in space, when a surface offers none; empty when neither a
/// surface nor the inside does.
[[nodiscard]] PressedNodes pressed_nodes(const Board& board, const Crack& crack, const Press& press,
                                         std::span<const std::uint8_t> destroyed);

}  // namespace sunder::fracture
