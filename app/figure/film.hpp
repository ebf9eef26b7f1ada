// SPDX-License-Identifier: Apache-2.0
// States of one problem side by side, drawn to one scale.
#pragma once

#include <span>
#include <string>
#include <vector>

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

struct FilmPicture {
  State state;
  std::string caption;
};

/// The states of a body side by side, each under its caption: a complete SVG document.
[[nodiscard]] std::string film_strip(const FigurePainter& painter, const std::string& title,
                                     std::span<const FilmPicture> pictures);

/// Takes pictures while a run goes on: in motion at the end of each sixth of its time, of cracks
/// that split when they have grown.
class FilmReel {
 public:
  /// The problem must outlive it.
  explicit FilmReel(const Problem& problem) : problem_(problem) {}

  void step_done(const StepReport& report, const State& state);
  /// At most six; those of a tear are about as far from each other in area.
  [[nodiscard]] std::vector<FilmPicture> pictures() const;

 private:
  void add_in_motion(const StepReport& report, const State& state);
  void add_torn(const StepReport& report, const State& state);

  const Problem& problem_;
  std::vector<FilmPicture> taken_;
  std::vector<double> areas_;  ///< of cracks that have split, per picture [mm^2]
};

}  // namespace sunder::app
