// SPDX-License-Identifier: Apache-2.0
// Many triangles in one picture: as vectors while they are few, as an image when they are many.
#pragma once

#include <string>
#include <vector>

#include "app/figure/canvas.hpp"
#include "app/figure/raster.hpp"

namespace sunder::app {

/// In their order; corners are on the page of `canvas`, `edge_length` [px] is the mesh's there.
[[nodiscard]] std::string painted(const std::vector<PaintedTriangle>& triangles,
                                  const Canvas& canvas, double edge_length);

}  // namespace sunder::app
