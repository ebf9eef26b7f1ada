// SPDX-License-Identifier: Apache-2.0
// Pictures in the style of the paper's figures: front view of the deformed board, shades of red
// for stress, grey for the frame, yellow instruments, the crack path. A tear is a gap with outlined
// lips: destroyed elements are left out, and shown black on the undeformed body in an inset.
#pragma once

#include <memory>
#include <string>

#include "app/figure/canvas.hpp"
#include "app/output/state.hpp"
#include "sunder/board_plane.hpp"

namespace sunder::app {

class FaceTable;

/// Draws states of one problem; what depends on the mesh alone is prepared once.
class FigurePainter {
 public:
  explicit FigurePainter(const Problem& problem);
  ~FigurePainter();

  /// A complete SVG document; deterministic.
  [[nodiscard]] std::string svg(const State& state) const;
  /// What the picture of a state covers in the plane [mm].
  [[nodiscard]] Bounds bounds(const State& state) const;
  /// By which displacements are magnified or reduced in it.
  [[nodiscard]] double displacement_scale(const State& state) const;
  /// The state alone, without title, colour bar and caption: to be set among others.
  [[nodiscard]] std::string drawing(const State& state, const Canvas& canvas) const;
  /// The same picture as PNG.
  [[nodiscard]] static std::string png(const std::string& svg);

 private:
  struct Scenery;
  [[nodiscard]] Scenery scenery(const State& state) const;
  [[nodiscard]] std::string draw_body(const State& state, const Scenery& scene,
                                      const Canvas& canvas) const;

  const Problem& problem_;
  BoardPlane plane_;
  std::unique_ptr<FaceTable> faces_;
};

}  // namespace sunder::app
