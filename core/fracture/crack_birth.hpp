// SPDX-License-Identifier: Apache-2.0
// How a crack comes to be: from a preset of the scene, or from a rupture (method.md 4).
#pragma once

#include "fracture/board.hpp"
#include "fracture/in_plane_stress.hpp"
#include "sunder/crack.hpp"
#include "sunder/scene.hpp"

namespace sunder::fracture {

/// A tip within 0.05 h of the outline, or beyond it, has ended.
[[nodiscard]] bool at_outline(const Board& board, const Vec2& tip);

/// The crack of a preset. Throws InputError when its path has no length in the board's plane.
[[nodiscard]] Crack preset_crack(
    const Board& board, const PresetCrack& preset, int id, const std::vector<Index>& elements,
    std::pmr::memory_resource* lists = std::pmr::get_default_resource());

/// The crack that the rupture of `element` under the in-plane stress starts.
[[nodiscard]] Crack born_crack(const Board& board, Index element, const InPlane& stress, int id,
                               std::pmr::memory_resource* lists = std::pmr::get_default_resource());

}  // namespace sunder::fracture
