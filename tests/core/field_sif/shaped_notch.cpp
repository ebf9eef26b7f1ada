// SPDX-License-Identifier: Apache-2.0
#include "core/field_sif/shaped_notch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/field_sif/cracked_board.hpp"

namespace sunder::test {
namespace {

GridLines strip_lines(int n) {
  return {even_lines(n, 1.0), graded_lines(1.0, 0.2 * n, 3.0 * n, 1.1), even_lines(1, 1.0)};
}

/// Split nodes between two x, moved apart along y by `half` of x each: less and less of it up to
/// `tall` above and below, so that elements stay whole.
Scene opened(const GridLines& lines, std::pair<double, double> ends, double y, double tall,
             const std::function<double(double)>& half) {
  CrackedBoardOptions options;
  options.made = CrackMade::split;
  const CrackedBoard closed(lines, ends.first, ends.second, y, options);
  Scene scene = closed.problem().scene();
  const Index copies = grid_node_count(scene.mesh);
  for (Index i = 0; i < scene.mesh.node_count(); ++i) {
    Vec3& p = scene.mesh.nodes[i];
    const double above = p.y() - y;
    const bool upper = std::abs(above) > kClose ? above > 0 : i >= copies;
    const double share = std::max(0.0, 1 - std::abs(above) / tall);
    p.y() += (upper ? 1 : -1) * share * half(p.x());
  }
  return scene;
}

CrackedBody pulled(Scene scene, double cells, double y) {
  PresetCrack preset;
  preset.elements = std::vector<Index>{};
  preset.mouth = Vec3(0, y, 0.5);
  preset.tips = {Vec3(cells, y, 0.5)};
  scene.cracks = {preset};
  CrackedBody body(std::move(scene));
  body.set_crack(CrackKind::edge, {0, y}, {cells, y}, {});
  body.load_uniform(0, 1, 0);
  body.solve();
  return body;
}

}  // namespace

Scene cut_out(Scene scene, const std::function<bool(const Vec3&)>& hole) {
  Mesh left;
  left.volumes = scene.mesh.volumes;
  std::vector<Index> place(scene.mesh.nodes.size(), kNone);
  for (Index e = 0; e < scene.mesh.tet_count(); ++e) {
    auto tet = scene.mesh.tets[e];
    Vec3 centre = Vec3::Zero();
    for (Index n : tet) centre += scene.mesh.nodes[n] / 4;
    if (hole(centre)) continue;
    for (Index& n : tet) {
      if (place[n] == kNone) {
        place[n] = left.node_count();
        left.nodes.push_back(scene.mesh.nodes[n]);
      }
      n = place[n];
    }
    left.tets.push_back(tet);
    left.volume_of.push_back(scene.mesh.volume_of[e]);
  }
  for (Support& support : scene.supports)
    if (auto* ids = std::get_if<std::vector<Index>>(&support.nodes))
      for (Index& n : *ids) n = place[n];
  scene.mesh = std::move(left);
  return scene;
}

CrackedBody slotted_strip(int n, int cells, int rows) {
  const CrackedBoard whole(strip_lines(n), 0, 0.5, 0, {});
  return pulled(
      cut_out(whole.problem().scene(),
              [&](const Vec3& c) { return c.x() < cells && std::abs(c.y()) < rows / 2.0; }),
      cells, 0);
}

CrackedBody opened_strip(int n, int cells, const std::function<double(double)>& half) {
  const GridLines lines = strip_lines(n);
  const double y = lines.y[lines.y.size() / 2];
  Scene scene = opened(lines, {0, cells}, y, 1.8 * n,
                       [&](double x) { return x > cells - kClose ? 0.0 : half(cells - x); });
  return pulled(std::move(scene), cells, y);
}

CrackedBody opened_plate(int cells, double degrees) {
  const double a = cells, slope = std::tan(degrees * std::numbers::pi / 360);
  std::vector<double> across = graded_lines(1, a + 12, 10 * a, 1.15);
  for (double& x : across) x -= 0.5;  // tips on grid lines
  const GridLines lines{across, across, even_lines(1, 1)};
  const double y = across[across.size() / 2];
  Scene scene = opened(lines, {-a, a}, y, 9 * a,
                       [&](double x) { return slope * std::max(a - std::abs(x), 0.0); });
  PresetCrack preset;
  preset.elements = std::vector<Index>{};
  preset.tips = {Vec3(-a, y, 0.5), Vec3(a, y, 0.5)};
  scene.cracks = {preset};
  CrackedBody body(std::move(scene));
  body.set_crack(CrackKind::internal, {-a, y}, {a, y}, {});
  return body;
}

CrackedBody v_strip(int n, int cells, double degrees) {
  const double slope = std::tan(degrees * std::numbers::pi / 360);
  return opened_strip(n, cells, [slope](double behind) { return slope * behind; });
}

}  // namespace sunder::test
