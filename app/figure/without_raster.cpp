// SPDX-License-Identifier: Apache-2.0
// In place of raster.cpp in a build without librsvg (SUNDER_PICTURES=OFF).
#include "app/figure/raster.hpp"
#include "app/output/result_file.hpp"

namespace sunder::app {
namespace {

[[noreturn]] void refuse() {
  throw OutputError("this build makes no PNG: it was built without librsvg (SUNDER_PICTURES=OFF)");
}

}  // namespace

bool draws_pixels() noexcept { return false; }

std::string png_of_svg(std::string_view, double) { refuse(); }

std::string png_of_pixels(const Pixels&, std::string_view) { refuse(); }

std::string png_of_triangles(const std::vector<PaintedTriangle>&, const Vec2&, const Vec2&, double,
                             double) {
  refuse();
}

}  // namespace sunder::app
