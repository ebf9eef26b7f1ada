// SPDX-License-Identifier: Apache-2.0
#include "bench/study/board.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "support/loads.hpp"
#include "support/sequences.hpp"
#include "support/sliver.hpp"
#include "support/structured_board.hpp"

namespace sunder::bench {
namespace {

constexpr double kSide = 50, kRow = 27.5;  // kRow: middle of a row of cells of the upper half

Scene scene_of(const Difficulty& difficulty) {
  Scene scene;
  scene.title = "board of the stability study";
  scene.mesh =
      test::structured_board({10, 10, difficulty.layers, kSide, kSide, 5}, [](const Vec3& x) {
        return x.y() > 45   ? "top-frame"
               : x.y() < 5  ? "bottom-frame"
               : x.y() > 25 ? "upper"
                            : "lower";
      });
  if (difficulty.sliver < 1)
    test::make_sliver(scene.mesh, Vec3(25, 37.5, 2.5), 2.5, difficulty.sliver);
  const double frame = 5 * difficulty.contrast, nu = difficulty.poisson;
  scene.materials = {{"upper", {5, nu, 2.0}},
                     {"lower", {8, nu, 4.0}},
                     {"top-frame", {frame, nu, std::nullopt}},
                     {"bottom-frame", {frame, nu, std::nullopt}}};
  if (difficulty.pooled) {
    for (auto& [name, material] : scene.materials) material.volume = MaterialVolume::pooled;
  }
  const double s = difficulty.unit;
  for (Vec3& x : scene.mesh.nodes) x *= s;
  scene.supports.push_back({Box{Vec3(-1, 49.99, -1) * s, Vec3(51, 50.01, 6) * s}, Axes{7}});
  scene.fracture.alpha = difficulty.alpha;
  return scene;
}

bool cuts_off(const std::string& pattern) { return pattern == "cut" || pattern == "island"; }

std::vector<double> force_on(const Mesh& mesh, const Difficulty& difficulty) {
  const double s = difficulty.unit, newton = s * s;
  const auto corner = test::nodes_in(mesh, {Vec3(49.9, -1, -1) * s, Vec3(51, 0.1, 6) * s});
  const auto attached = test::nodes_in(mesh, {Vec3(49.9, 34, -1) * s, Vec3(51, 46, 6) * s});
  // What hangs on destroyed elements alone moves by force / alpha: a small share of the pull.
  const double share = difficulty.pattern == "cut" ? difficulty.alpha : 1;
  auto force = test::shared_force(mesh, corner, Vec3(0, -60, 0) * newton * share);
  if (cuts_off(difficulty.pattern)) {
    const auto second = test::shared_force(mesh, attached, Vec3(20, 0, 0) * newton);
    for (std::size_t i = 0; i < force.size(); ++i) force[i] += second[i];
  }
  return force;
}

/// All elements that touch a ball but do not lie in it: what is inside becomes an island.
std::vector<Index> shell(const Mesh& mesh, const Vec3& center, double radius) {
  std::set<Index> inside;
  for (Index n = 0; n < mesh.node_count(); ++n) {
    const Vec3 d = mesh.nodes[n] - center;
    if (std::hypot(d.x(), d.y()) < radius) inside.insert(n);
  }
  std::vector<Index> elements;
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    const auto& t = mesh.tets[e];
    const auto in = std::count_if(t.begin(), t.end(), [&](Index n) { return inside.contains(n); });
    if (in > 0 && in < 4) elements.push_back(e);
  }
  return elements;
}

std::vector<Index> removed_by(const Problem& problem, const Difficulty& difficulty) {
  const Mesh& mesh = problem.mesh();
  const double s = difficulty.unit;
  const std::string& pattern = difficulty.pattern;
  if (pattern == "scattered") return test::scattered_sequence(problem, difficulty.fractures);
  if (pattern == "island") return shell(mesh, Vec3(25, 35, 2.5) * s, 5.1 * s);
  if (pattern == "cut") return test::elements_across(mesh, kRow * s);
  if (pattern == "bridge") {
    auto across = test::elements_across(mesh, kRow * s);
    across.pop_back();
    return across;
  }
  if (pattern != "crack") throw std::invalid_argument("unknown pattern " + pattern);
  std::vector<Index> sequence;
  for (double row : {kRow, kRow + 5, kRow - 5, kRow + 10, kRow - 10, kRow + 15, kRow - 15}) {
    for (Index e : test::elements_across(mesh, row * s)) {
      if (static_cast<int>(sequence.size()) == difficulty.fractures) return sequence;
      const bool taken = std::find(sequence.begin(), sequence.end(), e) != sequence.end();
      const bool ahead = test::centroid(mesh, e).x() > 12 * s;
      if (!taken && ahead && problem.breakable(e)) sequence.push_back(e);
    }
  }
  return sequence;
}

}  // namespace

DifficultBoard difficult_board(const Difficulty& difficulty) {
  DifficultBoard board;
  board.problem = std::make_shared<Problem>(scene_of(difficulty));
  board.force = force_on(board.problem->mesh(), difficulty);
  board.removed = removed_by(*board.problem, difficulty);
  return board;
}

}  // namespace sunder::bench
