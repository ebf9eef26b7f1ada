// SPDX-License-Identifier: Apache-2.0
// Pictures of finished frames.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/view/overlay.hpp"
#include "app/view/shown.hpp"
#include "app/view/vulkan/renderer.hpp"

namespace sunder::app {

class Painter {
 public:
  /// Which must outlive it.
  Painter(view::Device& device, const PictureSize& size);

  /// The version of triangles that it has, of the body that it has drawn last; a frame to be drawn
  /// was shown since that one or an earlier one, or is another body's.
  [[nodiscard]] std::uint64_t version() const { return version_; }
  /// Draws a frame; what stands over it is beside, in over().
  void draw(std::shared_ptr<const Shown> shown, const Look& look, const Camera& camera);

  /// The last drawing as PNG with what stands over it.
  [[nodiscard]] std::string png() const;
  [[nodiscard]] Pixels pixels() const { return renderer_.read(); }
  [[nodiscard]] const Overlay& over() const { return over_; }
  [[nodiscard]] const view::Renderer& renderer() const { return renderer_; }

 private:
  const view::Device& device_;
  view::Renderer renderer_;
  std::uint64_t version_ = 0;
  std::shared_ptr<const Shown> shown_;  // that the device has
  std::vector<std::uint8_t> grey_;      // of its body, by element
  Overlay over_;
};

/// Pictures side by side, each under its caption, as one PNG.
struct FilmFrame {
  std::string png, caption;
};
[[nodiscard]] std::string film_of(const std::string& title, const std::vector<FilmFrame>& frames,
                                  const PictureSize& size);

}  // namespace sunder::app
