// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/measures.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

namespace sunder::app::reproduce {
namespace {

double slope_deg(const Vec2& from, const Vec2& to) {
  const Vec2 way = to - from;
  return way.norm() > 0 ? std::atan2(way.y(), way.x()) * 180 / std::numbers::pi : 0;
}

std::set<Index> first_elements(std::span<const DestroyedElement> rows, std::size_t count) {
  std::set<Index> ids;
  for (const DestroyedElement& row : rows.subspan(0, std::min(count, rows.size())))
    ids.insert(row.element);
  return ids;
}

Vec2 centroid_in_plane(const RunResult& run, Index e) {
  const Mesh& mesh = run.problem->mesh();
  Vec3 sum = Vec3::Zero();
  for (const Index node : mesh.tets[e]) sum += mesh.nodes[node] / 4;
  return run.plane.project(sum);
}

/// Of the live breakable element with the largest yield ratio.
std::optional<Vec2> place_of_peak(const RunResult& run, const State& state) {
  const std::vector<double> ratios = yield_ratios(*run.problem, state);
  const auto peak = std::max_element(ratios.begin(), ratios.end());
  if (peak == ratios.end() || !(*peak > 0)) return std::nullopt;
  return centroid_in_plane(run, static_cast<Index>(peak - ratios.begin()));
}

double nearer(const std::optional<double>& known, double found) {
  return known ? std::min(*known, found) : found;
}

Index root(std::vector<Index>& parent, Index i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

std::optional<double> GrownPath::height(double x) const {
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec2 &a = points[i], &b = points[i + 1];
    if (x < a.x() || x > b.x() || !(b.x() > a.x())) continue;
    return a.y() + (b.y() - a.y()) * (x - a.x()) / (b.x() - a.x());
  }
  return std::nullopt;
}

GrownPath grown_path(const Crack& crack, const Vec2& start, const Vec2& direction) {
  const Vec2 d = direction.normalized();
  Vec2 up(-d.y(), d.x());
  if (up.y() < 0) up = -up;
  GrownPath path;
  path.points.emplace_back(0, 0);
  for (const Vec2& p : crack.path) {
    const Vec2 local((p - start).dot(d), (p - start).dot(up));
    if (local.x() > 1e-9) path.points.push_back(local);
  }
  return path;
}

GrownPath preset_path(const RunResult& run) {
  const PresetCrack& preset = run.problem->scene().cracks.at(0);
  const Vec2 mouth = run.plane.project(preset.mouth.value());
  const Vec2 tip = run.plane.project(preset.tips.at(0));
  if (run.cracks.empty()) return {{Vec2::Zero()}};
  return grown_path(run.cracks.front(), tip, tip - mouth);
}

std::optional<GrownPath> born_path(const RunResult& run) {
  if (run.cracks.empty() || !run.cracks.front().mouth) return std::nullopt;
  const Vec2 mouth = *run.cracks.front().mouth;
  const Vec2 to_low = mouth - run.plane.outline_min, to_high = run.plane.outline_max - mouth;
  const double nearest = std::min(to_low.minCoeff(), to_high.minCoeff());
  Vec2 inwards = Vec2::Zero();
  for (int axis = 0; axis < 2; ++axis) {
    if (to_low[axis] == nearest) inwards[axis] = 1;
    if (to_high[axis] == nearest) inwards[axis] = -1;
  }
  return grown_path(run.cracks.front(), mouth, inwards);
}

Turns turns_of(const GrownPath& path) {
  if (path.points.size() < 2) return {};
  const auto top = std::max_element(path.points.begin(), path.points.end(),
                                    [](const Vec2& a, const Vec2& b) { return a.y() < b.y(); });
  double dip = 0;
  for (auto p = path.points.begin(); p != top; ++p) dip = std::min(dip, p->y());
  return {slope_deg(path.points.front(), *top), slope_deg(*top, path.points.back()), top->y(),
          path.points.back().y(), dip};
}

Deviation deviation(const GrownPath& a, const GrownPath& b) {
  constexpr int kStations = 200;
  Deviation found;
  found.common = std::min(a.advance(), b.advance());
  int counted = 0;
  for (int i = 0; i <= kStations; ++i) {
    const double x = found.common * i / kStations;
    const auto ya = a.height(x), yb = b.height(x);
    if (!ya || !yb) continue;
    const double apart = std::abs(*ya - *yb);
    found.mean += apart;
    found.largest = std::max(found.largest, apart);
    ++counted;
  }
  if (counted > 0) found.mean /= counted;
  return found;
}

double overlap(std::span<const DestroyedElement> a, std::span<const DestroyedElement> b,
               std::size_t count) {
  const std::set<Index> ia = first_elements(a, count), ib = first_elements(b, count);
  std::vector<Index> both;
  std::set_intersection(ia.begin(), ia.end(), ib.begin(), ib.end(), std::back_inserter(both));
  const std::size_t all = ia.size() + ib.size() - both.size();
  return all == 0 ? 0 : static_cast<double>(both.size()) / static_cast<double>(all);
}

double connected_share(const Mesh& mesh, std::span<const DestroyedElement> rows) {
  if (rows.empty()) return 0;
  std::vector<Index> parent(mesh.nodes.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  for (const DestroyedElement& row : rows)
    for (const Index node : mesh.tets[row.element])
      parent[root(parent, node)] = root(parent, mesh.tets[row.element][0]);
  std::map<Index, int> sizes;
  int largest = 0;
  for (const DestroyedElement& row : rows)
    largest = std::max(largest, ++sizes[root(parent, mesh.tets[row.element][0])]);
  return largest / static_cast<double>(rows.size());
}

std::optional<double> peak_to_tip(const RunResult& run, const State& state) {
  const auto peak = place_of_peak(run, state);
  if (!peak) return std::nullopt;
  std::optional<double> nearest;
  for (const Crack& crack : state.cracks)
    for (const CrackTip& tip : crack.tips)
      nearest = nearer(nearest, (*peak - tip.position).norm() / run.plane.edge_length);
  return nearest;
}

std::optional<double> peak_to_damage(const RunResult& run, const State& state) {
  const auto peak = place_of_peak(run, state);
  if (!peak) return std::nullopt;
  std::optional<double> nearest;
  for (Index e = 0; e < run.problem->tet_count(); ++e)
    if (state.destroyed[e])
      nearest = nearer(nearest, (*peak - centroid_in_plane(run, e)).norm() / run.plane.edge_length);
  return nearest;
}

double largest_free_ratio(const RunResult& run, const State& state) {
  const Mesh& mesh = run.problem->mesh();
  std::vector<std::uint8_t> at_crack(mesh.nodes.size(), 0);
  for (const Crack& crack : state.cracks)
    for (const Index e : crack.elements)
      for (const Index node : mesh.tets[e]) at_crack[node] = 1;
  const std::vector<double> ratios = yield_ratios(*run.problem, state);
  double largest = 0;
  for (Index e = 0; e < static_cast<Index>(ratios.size()); ++e) {
    const auto& corners = mesh.tets[e];
    const bool free = std::none_of(corners.begin(), corners.end(),
                                   [&](Index node) { return at_crack[node] != 0; });
    if (free) largest = std::max(largest, ratios[e]);
  }
  return largest;
}

double power(std::span<const Vec2> points) {
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : points)
    mean += Vec2(std::log(p.x()), std::log(p.y())) / static_cast<double>(points.size());
  double xy = 0, xx = 0;
  for (const Vec2& p : points) {
    const Vec2 from_mean = Vec2(std::log(p.x()), std::log(p.y())) - mean;
    xy += from_mean.x() * from_mean.y();
    xx += from_mean.x() * from_mean.x();
  }
  return xx > 0 ? xy / xx : 0;
}

}  // namespace sunder::app::reproduce
