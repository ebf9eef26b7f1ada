// SPDX-License-Identifier: Apache-2.0
#include "app/figure/film.hpp"

#include "app/figure/svg.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

constexpr double kWidth = 190, kGap = 10, kTop = 46;

}  // namespace

std::string panel(const FigurePainter& painter, const State& state, const std::string& title,
                  const Canvas& canvas, const Vec2& at, const Vec2& size) {
  const Vec2 corner = canvas.corner() - Vec2::Constant(kPanelInset);
  const Vec2 shown = canvas.size() + Vec2::Constant(2 * kPanelInset);
  const auto c = [](double v) { return svg::coordinate(v); };
  return svg::text({at.x() + 2, at.y() + 14}, title, "fill=\"#222\"") + "<svg x=\"" + c(at.x()) +
         "\" y=\"" + c(at.y() + kPanelTitle) + "\" width=\"" + c(size.x()) + "\" height=\"" +
         c(size.y()) + "\" viewBox=\"" + c(corner.x()) + " " + c(corner.y()) + " " + c(shown.x()) +
         " " + c(shown.y()) + "\">\n" + painter.drawing(state, canvas) + "</svg>\n";
}

double panel_height(const Canvas& canvas, double width) {
  return width * (canvas.size().y() + 2 * kPanelInset) / (canvas.size().x() + 2 * kPanelInset);
}

std::string film_strip(const FigurePainter& painter, const std::string& title,
                       std::span<const State> states, std::span<const double> times) {
  Bounds bounds;
  for (const State& state : states) {
    const Bounds own = painter.bounds(state);
    bounds.add(own.min);
    bounds.add(own.max);
  }
  const Canvas canvas(bounds);
  const Vec2 size(kWidth, panel_height(canvas, kWidth));
  const Vec2 page(kGap + static_cast<double>(states.size()) * (kWidth + kGap),
                  kTop + kPanelTitle + size.y() + kGap);
  std::string out =
      svg::open(page.x(), page.y(),
                "font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"12.5\"") +
      "<title>" + escaped(title) + "</title>\n" + svg::rect({0, 0}, page, "fill=\"#fff\"") +
      svg::text({kGap, 28}, title, "font-size=\"17\" font-weight=\"bold\" fill=\"#222\"");
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Vec2 at(kGap + static_cast<double>(i) * (kWidth + kGap), kTop);
    out += panel(painter, states[i], rounded(times[i], 3) + " s", canvas, at, size);
  }
  return out + "</svg>\n";
}

}  // namespace sunder::app
