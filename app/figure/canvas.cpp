// SPDX-License-Identifier: Apache-2.0
#include "app/figure/canvas.hpp"

#include <algorithm>

#include "app/figure/svg.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

constexpr double kMargin = 28, kTitle = 66, kBar = 118;
constexpr double kWidth = 640, kLeastHeight = 150, kMostHeight = 680;
constexpr double kInsetGap = 22, kInsetBelow = 10;

/// A long title gets smaller letters; bold ones are about 0.66 of their size wide.
double title_size(std::string_view title, double page_width) {
  const double fits = (page_width - 2 * kMargin) / (0.66 * static_cast<double>(title.size() + 1));
  return std::clamp(fits, 9.0, 18.0);
}

}  // namespace

Canvas::Canvas(const Bounds& bounds, double caption)
    : bounds_(bounds), corner_(kMargin, kTitle), caption_(caption) {
  const Vec2 extent = (bounds.max - bounds.min).cwiseMax(1e-12);
  scale_ = std::min(kWidth / extent.x(), kMostHeight / extent.y());
  size_ = {kWidth, std::max(extent.y() * scale_, kLeastHeight)};
}

Vec2 Canvas::map(const Vec2& p) const {
  const Vec2 from_middle = (p - (bounds_.min + bounds_.max) / 2) * scale_;
  return corner_ + size_ / 2 + Vec2(from_middle.x(), -from_middle.y());
}

double Canvas::page_width() const { return kMargin + kWidth + kBar + kMargin; }
double Canvas::page_height() const { return kTitle + size_.y() + caption_; }

Vec2 Canvas::inset_corner() const {
  return {page_width() - kMargin - inset_size().x(), corner_.y() + size_.y() + kInsetGap};
}
Vec2 Canvas::inset_size() const { return {kBar, caption_ - kInsetGap - kInsetBelow}; }

std::string Canvas::open(std::string_view title) const {
  return svg::open(page_width(), page_height(),
                   "font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"12.5\"") +
         "<title>" + escaped(title) + "</title>\n" +
         svg::rect({0, 0}, {page_width(), page_height()}, "fill=\"#fff\"") +
         svg::text({kMargin, 34}, title,
                   "font-size=\"" + svg::coordinate(title_size(title, page_width())) +
                       "\" font-weight=\"bold\" fill=\"#222\"");
}

}  // namespace sunder::app
