// SPDX-License-Identifier: Apache-2.0
#include "app/figure/shading.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sunder/fracture_model.hpp"

namespace sunder::app {
namespace {

constexpr double kShade = 0.8;

/// ColorBrewer "Reds", nine classes: even steps of lightness.
constexpr std::array<Color, 9> kReds{{{255, 245, 240},
                                      {254, 224, 210},
                                      {252, 187, 161},
                                      {252, 146, 114},
                                      {251, 106, 74},
                                      {239, 59, 44},
                                      {203, 24, 29},
                                      {165, 15, 21},
                                      {103, 0, 13}}};

/// Smallest of 1, 1.5, 2, 3, 4, 5, 6, 8, 10 times a power of ten that is not below x.
double round_up(double x) {
  if (!(x > 0) || !std::isfinite(x)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double lead : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (x <= lead * power) return lead * power;
  return 10 * power;
}

double maximum_of(const Problem& problem, const std::vector<double>& values,
                  const std::vector<std::uint8_t>& destroyed) {
  const bool frame = shows_frame(problem);
  std::vector<double> shown;
  for (Index e = 0; e < problem.tet_count(); ++e)
    if (!destroyed[e] && (!frame || problem.destructible(e))) shown.push_back(values[e]);
  return round_maximum(std::move(shown));
}

}  // namespace

double round_maximum(std::vector<double> values) {
  if (values.empty()) return round_up(0);
  const auto rank = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 199 / 200);
  std::nth_element(values.begin(), rank, values.end());
  return round_up(*rank);
}

bool shows_frame(const Problem& problem) {
  for (Index e = 0; e < problem.tet_count(); ++e)
    if (problem.destructible(e)) return true;
  return false;
}

bool breaks_by_strength(const Problem& problem) {
  if (!row_of(problem.scene().fracture.model).breaks) return false;
  for (Index e = 0; e < problem.tet_count(); ++e)
    if (problem.breakable(e)) return true;
  return false;
}

std::optional<StressScale> stress_scale(const Problem& problem, const State& state) {
  if (state.stress.empty()) return std::nullopt;
  if (breaks_by_strength(problem)) {
    constexpr std::array kOverYield{"max. shear / yield", "Tresca stress / yield",
                                    "principal stress / yield"};  // by YieldMeasure
    const YieldMeasure measure = strength_measure(problem.scene().fracture);
    std::string label = kOverYield[static_cast<std::size_t>(measure)];
    if (problem.interfaces()) label += ", traction / strength";
    return StressScale{yield_ratios(problem, state), 1.0, std::move(label)};
  }
  StressScale scale{max_shears(state), 1.0, "max. shear [MPa]"};
  scale.maximum = maximum_of(problem, scale.value, state.destroyed);
  return scale;
}

std::span<const Color> reds() { return kReds; }

Color red(double share) {
  const double at = (share > 0 ? std::min(share, 1.0) : 0.0) * (kReds.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), kReds.size() - 2);
  const double t = at - static_cast<double>(low);
  const auto mix = [t](int a, int b) {
    return static_cast<std::uint8_t>(std::lround(a + t * (b - a)));
  };
  const Color a = kReds[low], b = kReds[low + 1];
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

std::vector<Color> element_colors(const Problem& problem, const State& state,
                                  const std::optional<StressScale>& scale) {
  const bool frame = shows_frame(problem);
  std::vector<Color> colors(state.destroyed.size(), kPlain);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (frame && !problem.destructible(e))
      colors[e] = kFrame;
    else if (scale)
      colors[e] = red(scale->value[e] / scale->maximum);
  }
  return colors;
}

Color shaded(Color color) {
  const auto dim = [](std::uint8_t channel) {
    return static_cast<std::uint8_t>(std::lround(kShade * channel));
  };
  return {dim(color.r), dim(color.g), dim(color.b)};
}

std::string hex(Color color) {
  static constexpr std::string_view digits = "0123456789abcdef";
  std::string out = "#";
  for (const std::uint8_t channel : {color.r, color.g, color.b}) {
    out += digits[channel >> 4];
    out += digits[channel & 15];
  }
  return out;
}

}  // namespace sunder::app
