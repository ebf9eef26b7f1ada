// SPDX-License-Identifier: Apache-2.0
// What is read off a run before it is judged.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "app/reproduce/laboratory.hpp"

namespace sunder::app::reproduce {

/// Shape of the way a crack grew: x is the distance along its first direction [mm], y the height
/// above it, upwards (e2) positive [mm].
struct GrownPath {
  std::vector<Vec2> points;  ///< from (0, 0), where growth began

  [[nodiscard]] double advance() const { return points.empty() ? 0 : points.back().x(); }
  /// Height at a distance; none beyond the path's end.
  [[nodiscard]] std::optional<double> height(double x) const;
};

/// Of an edge crack; `start`: where growth began (a preset's tip; the mouth of a crack born).
[[nodiscard]] GrownPath grown_path(const Crack& crack, const Vec2& start, const Vec2& direction);
/// Of the run's crack 0, a preset with a mouth.
[[nodiscard]] GrownPath preset_path(const RunResult& run);

/// Of the run's first crack, born at the rim: from its mouth straight into the body. None: there is
/// none, or it is internal.
[[nodiscard]] std::optional<GrownPath> born_path(const RunResult& run);

struct Turns {
  double rise_deg = 0;  ///< mean slope from the begin to the highest point
  double fall_deg = 0;  ///< mean slope from there to the end, falling is negative
  double highest = 0;   ///< [mm]
  double end = 0;       ///< height of the last point [mm]
  double dip = 0;       ///< lowest height before the highest point, 0 or below [mm]
};
[[nodiscard]] Turns turns_of(const GrownPath& path);

struct Deviation {
  double mean = 0, largest = 0;  ///< |height difference| [mm]
  double common = 0;             ///< length that both have [mm]
};
[[nodiscard]] Deviation deviation(const GrownPath& a, const GrownPath& b);

/// Shared elements over all elements of the first `count` fractures of both (Jaccard index).
[[nodiscard]] double overlap(std::span<const DestroyedElement> a,
                             std::span<const DestroyedElement> b, std::size_t count);

/// Share of the elements in the largest piece; elements that share a node belong together.
[[nodiscard]] double connected_share(const Mesh& mesh, std::span<const DestroyedElement> rows);

/// In-plane distance from the live breakable element with the largest yield ratio to the nearest
/// tip of any crack, in h; none without cracks.
[[nodiscard]] std::optional<double> peak_to_tip(const RunResult& run, const State& state);

/// The same to the nearest destroyed element: model A knows no tips.
[[nodiscard]] std::optional<double> peak_to_damage(const RunResult& run, const State& state);

/// Largest yield ratio of the live breakable elements that share no node with a crack's: those that
/// may rupture anew (method.md 11).
[[nodiscard]] double largest_free_ratio(const RunResult& run, const State& state);

/// Slope of log y over log x by least squares; two points or more.
[[nodiscard]] double power(std::span<const Vec2> points);

}  // namespace sunder::app::reproduce
