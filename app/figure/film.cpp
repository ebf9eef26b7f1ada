// SPDX-License-Identifier: Apache-2.0
#include "app/figure/film.hpp"

#include <cmath>
#include <utility>

#include "app/figure/svg.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

constexpr double kWidth = 190, kGap = 10, kTop = 46;
constexpr int kPictures = 6;

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
                       std::span<const FilmPicture> pictures) {
  Bounds bounds;
  for (const FilmPicture& picture : pictures) {
    const Bounds own = painter.bounds(picture.state);
    bounds.add(own.min);
    bounds.add(own.max);
  }
  const Canvas canvas(bounds);
  const Vec2 size(kWidth, panel_height(canvas, kWidth));
  const Vec2 page(kGap + static_cast<double>(pictures.size()) * (kWidth + kGap),
                  kTop + kPanelTitle + size.y() + kGap);
  std::string out =
      svg::open(page.x(), page.y(),
                "font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"12.5\"") +
      "<title>" + escaped(title) + "</title>\n" + svg::rect({0, 0}, page, "fill=\"#fff\"") +
      svg::text({kGap, 28}, title, "font-size=\"17\" font-weight=\"bold\" fill=\"#222\"");
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Vec2 at(kGap + static_cast<double>(i) * (kWidth + kGap), kTop);
    out += panel(painter, pictures[i].state, pictures[i].caption, canvas, at, size);
  }
  return out + "</svg>\n";
}

void FilmReel::step_done(const StepReport& report, const State& state) {
  if (problem_.moves()) {
    add_in_motion(report, state);
  } else if (state.split) {
    add_torn(report, state);
  }
}

void FilmReel::add_in_motion(const StepReport& report, const State& state) {
  const long long steps = problem_.scene().steps, before = kPictures * report.step / steps,
                  now = kPictures * (report.step + 1) / steps;
  if (now == before) return;
  taken_.push_back({state, rounded(report.motion->time, 3) + " s"});
}

/// How far it will tear is not known: where there are too many, every second one goes.
void FilmReel::add_torn(const StepReport& report, const State& state) {
  const double area = crack_area(*state.split);
  if (!areas_.empty() && !(area > areas_.back())) return;
  double length = 0;
  for (const Crack& crack : state.cracks) length += crack.length;
  taken_.push_back(
      {state, "load " + rounded(report.load_factor, 3) + ", crack " + rounded(length, 3) + " mm"});
  areas_.push_back(area);
  if (taken_.size() <= 2 * static_cast<std::size_t>(kPictures)) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < taken_.size(); i += 2, ++kept) {
    if (i == kept) continue;
    taken_[kept] = std::move(taken_[i]);
    areas_[kept] = areas_[i];
  }
  taken_.resize(kept);
  areas_.resize(kept);
}

std::vector<FilmPicture> FilmReel::pictures() const {
  if (areas_.empty()) return taken_;
  std::vector<FilmPicture> chosen;
  std::size_t next = 0;
  for (int i = 1; i <= kPictures && next < taken_.size(); ++i) {
    const double wanted = areas_.back() * i / kPictures;
    std::size_t nearest = next;
    for (std::size_t p = next; p < areas_.size(); ++p) {
      if (std::abs(areas_[p] - wanted) < std::abs(areas_[nearest] - wanted)) nearest = p;
    }
    chosen.push_back(taken_[nearest]);
    next = nearest + 1;
  }
  return chosen;
}

}  // namespace sunder::app
