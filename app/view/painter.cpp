// SPDX-License-Identifier: Apache-2.0
#include "app/view/painter.hpp"

#include <numeric>
#include <utility>
#include <vector>

#include "app/figure/raster.hpp"
#include "app/figure/svg.hpp"
#include "app/output/text.hpp"

namespace sunder::app {

Painter::Painter(view::Device& device, const PictureSize& size)
    : device_(device), renderer_(device, size) {}

void Painter::draw(std::shared_ptr<const Shown> shown, const Look& look, const Camera& camera) {
  const Problem& problem = *shown->problem;
  if (shown != shown_) {
    const bool other = !shown_ || shown_->problem != shown->problem;
    if (shown->version != version_ || other) {
      std::vector<std::uint32_t> all;
      // It was shown to another painter, before this one, or as what follows another body.
      if (shown->since > version_ || other) {
        all.resize(shown->triangles.size());
        std::iota(all.begin(), all.end(), 0U);
      }
      if (other) grey_ = unbreakable(problem);
      renderer_.set_triangles(shown->triangles, all.empty() ? shown->changed : all, grey_);
      renderer_.set_lips(shown->lips);
      version_ = shown->version;
    }
    if (shown->points && &shown->points->device == &device_) {
      renderer_.set_points(shown->points);
    } else if (shown->points) {  // they were on a device that was lost
      renderer_.set_points(shown->places, normals_of(shown->triangles, shown->places));
    } else {
      renderer_.set_points(shown->places, shown->normals);
    }
    shown_ = std::move(shown);
  }
  const input::Colour colour = look.colour.value_or(input::Colour{standard_field(problem), {}});
  const bool shared = renderer_.points() != nullptr;
  const Paint paint = app::paint(problem, shown_->state, shown_->triangles, colour,
                                 shared ? Values::on_device : Values::here);
  if (!shared) renderer_.set_values(paint.values);
  renderer_.draw(camera, look,
                 {!paint.label.empty(), paint.maximum, static_cast<std::uint32_t>(colour.field)});
  over_ = overlay(problem, *shown_, paint, look, camera);
}

std::string Painter::png() const {
  return png_of_pixels(renderer_.read(), svg_of(over_, renderer_.size()));
}

std::string film_of(const std::string& title, const std::vector<FilmFrame>& frames,
                    const PictureSize& size) {
  constexpr double kGap = 10, kTop = 46, kCaption = 20, kWidth = 320;
  const Vec2 each(kWidth, kWidth * size.height / size.width);
  const Vec2 page(kGap + static_cast<double>(frames.size()) * (kWidth + kGap),
                  kTop + kCaption + each.y() + kGap);
  std::string svg =
      svg::open(page.x(), page.y(),
                "font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"12.5\"") +
      svg::rect({0, 0}, page, "fill=\"#fff\"") +
      svg::text({kGap, 28}, title, "font-size=\"17\" font-weight=\"bold\" fill=\"#222\"");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Vec2 at(kGap + static_cast<double>(i) * (kWidth + kGap), kTop);
    svg += svg::text({at.x() + 2, at.y() + 14}, frames[i].caption, "fill=\"#222\"") +
           "<image x=\"" + svg::coordinate(at.x()) + "\" y=\"" +
           svg::coordinate(at.y() + kCaption) + "\" width=\"" + svg::coordinate(each.x()) +
           "\" height=\"" + svg::coordinate(each.y()) + "\" href=\"data:image/png;base64," +
           base64(frames[i].png) + "\"/>\n";
  }
  return png_of_svg(svg + "</svg>\n", 1);
}

}  // namespace sunder::app
