// SPDX-License-Identifier: Apache-2.0
// States of one problem side by side, drawn to one scale.
#pragma once

#include <span>
#include <string>

#include "app/figure/figure.hpp"

namespace sunder::app {

/// A drawing under its title, `width` x `height` [px] on the page; `canvas` covers what it shows.
[[nodiscard]] std::string panel(const FigurePainter& painter, const State& state,
                                const std::string& title, const Canvas& canvas, const Vec2& at,
                                const Vec2& size);
/// Height of its title [px]; what a drawing is framed by.
inline constexpr double kPanelTitle = 20, kPanelInset = 6;
/// Height of a drawing of that width.
[[nodiscard]] double panel_height(const Canvas& canvas, double width);

/// A body in motion at true scale, the time of each state [s] above it: a complete SVG document.
[[nodiscard]] std::string film_strip(const FigurePainter& painter, const std::string& title,
                                     std::span<const State> states, std::span<const double> times);

}  // namespace sunder::app
