// SPDX-License-Identifier: Apache-2.0
// The small picture beside the caption: where destroyed elements were, on the undeformed body.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "app/figure/surface.hpp"
#include "sunder/board_plane.hpp"

namespace sunder::app {

/// Fits into the rectangle from `corner` with `size` on the page.
[[nodiscard]] std::string destroyed_inset(const Mesh& mesh, const BoardPlane& plane,
                                          const FaceTable& faces,
                                          std::span<const std::uint8_t> destroyed,
                                          const Vec2& corner, const Vec2& size);

}  // namespace sunder::app
