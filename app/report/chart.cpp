// SPDX-License-Identifier: Apache-2.0
#include "app/report/chart.hpp"

#include <algorithm>
#include <cmath>

#include "app/figure/svg.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

constexpr double kWidth = 560, kHeight = 250;
constexpr double kLeft = 62, kRight = 14, kTop = 30, kBottom = 44;
constexpr std::size_t kMostBars = 120;

/// A range with round ticks.
struct Scale {
  double low = 0, high = 1;
  bool logarithmic = false;
  std::vector<double> ticks;

  [[nodiscard]] double share(double value) const {
    if (logarithmic)
      return (std::log10(value) - std::log10(low)) / (std::log10(high) - std::log10(low));
    return (value - low) / (high - low);
  }
};

double tick_step(double range) {
  const double raw = range / 5, power = std::pow(10.0, std::floor(std::log10(raw)));
  const double lead = raw / power;
  return (lead <= 1 ? 1 : lead <= 2 ? 2 : lead <= 5 ? 5 : 10) * power;
}

Scale linear(double low, double high, bool widen) {
  if (!(high > low)) high = low + (low == 0 ? 1 : std::abs(low));
  const double step = tick_step(high - low);
  Scale scale{low, high, false, {}};
  if (widen) {
    scale.low = std::floor(low / step) * step;
    scale.high = std::ceil(high / step) * step;
  }
  const auto first = std::llround(std::ceil(scale.low / step - 1e-9));
  const auto last = std::llround(std::floor(scale.high / step + 1e-9));
  for (auto i = first; i <= last; ++i) scale.ticks.push_back(static_cast<double>(i) * step);
  return scale;
}

Scale logarithmic(double low, double high) {
  const double bottom = std::floor(std::log10(low)), top = std::ceil(std::log10(high));
  Scale scale{std::pow(10.0, bottom), std::pow(10.0, std::max(top, bottom + 1)), true, {}};
  const double decades = std::max(top, bottom + 1) - bottom;
  const double step = std::max(1.0, std::ceil(decades / 6));
  for (double e = bottom; e <= bottom + decades; e += step)
    scale.ticks.push_back(std::pow(10.0, e));
  return scale;
}

Vec2 place(const Scale& x, const Scale& y, const Vec2& p) {
  return {kLeft + x.share(p.x()) * (kWidth - kLeft - kRight),
          kHeight - kBottom - y.share(p.y()) * (kHeight - kTop - kBottom)};
}

std::string open_chart(const ChartAxes& axes) {
  return "<svg class=\"chart\" viewBox=\"0 0 " + svg::coordinate(kWidth) + " " +
         svg::coordinate(kHeight) + "\" role=\"img\" aria-label=\"" + escaped(axes.y) + " over " +
         escaped(axes.x) + "\">\n";
}

std::string axes_of(const Scale& x, const Scale& y, const ChartAxes& axes) {
  std::string out;
  for (const double tick : y.ticks) {
    const Vec2 at = place(x, y, {x.low, tick});
    out += svg::line(at, {kWidth - kRight, at.y()}, "class=\"grid\"");
    out +=
        svg::text({kLeft - 7, at.y() + 4}, rounded(tick, 4), "class=\"tick\" text-anchor=\"end\"");
  }
  for (const double tick : x.ticks) {
    const Vec2 at = place(x, y, {tick, y.low});
    out += svg::line(at, {at.x(), at.y() + 4}, "class=\"axis\"");
    out +=
        svg::text({at.x(), at.y() + 17}, rounded(tick, 6), "class=\"tick\" text-anchor=\"middle\"");
  }
  out +=
      svg::line({kLeft, kHeight - kBottom}, {kWidth - kRight, kHeight - kBottom}, "class=\"axis\"");
  out += svg::text({(kLeft + kWidth - kRight) / 2, kHeight - 8}, axes.x,
                   "class=\"label\" text-anchor=\"middle\"");
  return out + svg::text({6, 17}, axes.y, "class=\"label\"");
}

std::string legend(const std::vector<std::string>& names) {
  if (names.size() < 2) return {};
  std::string out;
  double right = kWidth - kRight;
  for (std::size_t i = names.size(); i-- > 0;) {
    const double width = 7.0 * static_cast<double>(names[i].size()) + 24;
    right -= width;
    out += svg::rect({right, 8}, {10, 10}, "class=\"f" + std::to_string(i) + "\"");
    out += svg::text({right + 14, 17}, names[i], "class=\"tick\"");
  }
  return out;
}

std::vector<Vec2> drawable(const ChartSeries& series, bool logarithmic) {
  std::vector<Vec2> points;
  for (const Vec2& p : series.points)
    if (p.allFinite() && (!logarithmic || p.y() > 0)) points.push_back(p);
  return points;
}

std::string curve(const ChartSeries& series, const std::vector<Vec2>& points, const Scale& x,
                  const Scale& y, std::size_t index) {
  std::vector<Vec2> drawn;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (series.steps && i > 0) drawn.push_back(place(x, y, {points[i].x(), points[i - 1].y()}));
    drawn.push_back(place(x, y, points[i]));
  }
  const std::string number = std::to_string(index);
  std::string out = svg::polyline(drawn, "class=\"s" + number + "\"");
  if (points.size() <= 60 && !series.steps)
    for (const Vec2& p : points)
      out += svg::circle(place(x, y, p), 2.4, "class=\"f" + number + "\"");
  return out;
}

}  // namespace

std::string line_chart(const std::vector<ChartSeries>& series, const ChartAxes& axes) {
  std::vector<std::vector<Vec2>> all;
  std::vector<std::string> names;
  Vec2 low = Vec2::Constant(1e300), high = Vec2::Constant(-1e300);
  for (const ChartSeries& s : series) {
    all.push_back(drawable(s, axes.logarithmic));
    names.push_back(s.name);
    for (const Vec2& p : all.back()) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  if (!(low.x() <= high.x()))
    return "<p class=\"note\">Nothing to plot: all values are zero.</p>\n";
  const Scale x = linear(low.x(), high.x(), false);
  const Scale y = axes.logarithmic ? logarithmic(low.y(), high.y())
                                   : linear(std::min(low.y(), 0.0), std::max(high.y(), 0.0), true);
  std::string out = open_chart(axes) + axes_of(x, y, axes) + legend(names);
  for (std::size_t i = 0; i < series.size(); ++i) out += curve(series[i], all[i], x, y, i);
  return out + "</svg>\n";
}

std::string stacked_bars(const std::vector<std::string>& names,
                         const std::vector<std::vector<double>>& bars, const ChartAxes& axes) {
  if (bars.empty()) return "<p class=\"note\">No step was done.</p>\n";
  const std::size_t join = (bars.size() + kMostBars - 1) / kMostBars;
  std::vector<std::vector<double>> joined((bars.size() + join - 1) / join,
                                          std::vector<double>(names.size(), 0.0));
  double highest = 0;
  for (std::size_t i = 0; i < bars.size(); ++i)
    for (std::size_t k = 0; k < names.size(); ++k) joined[i / join][k] += bars[i][k];
  for (const auto& bar : joined) {
    double sum = 0;
    for (const double part : bar) sum += part;
    highest = std::max(highest, sum);
  }
  const Scale x = linear(0, static_cast<double>(bars.size()), false);
  const Scale y = linear(0, highest, true);
  std::string out = open_chart(axes) + axes_of(x, y, axes) + legend(names);
  for (std::size_t i = 0; i < joined.size(); ++i) {
    const double begin = static_cast<double>(i * join);
    const double end =
        std::min(begin + static_cast<double>(join), static_cast<double>(bars.size()));
    double bottom = 0;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const Vec2 a = place(x, y, {begin, bottom + joined[i][k]}), b = place(x, y, {end, bottom});
      bottom += joined[i][k];
      const Vec2 size(std::max(b.x() - a.x() - 1, 0.5), b.y() - a.y());
      if (size.y() > 0.05) out += svg::rect(a, size, "class=\"f" + std::to_string(k) + "\"");
    }
  }
  return out + "</svg>\n";
}

}  // namespace sunder::app
