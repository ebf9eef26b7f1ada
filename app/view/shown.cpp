// SPDX-License-Identifier: Apache-2.0
#include "app/view/shown.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sunder::app {

State state_of(const Simulation& simulation) {
  if (simulation.steps_done() > 0) return capture(simulation, simulation.steps_done() - 1);
  State state = undeformed(simulation.problem());
  const auto destroyed = simulation.backend().destroyed();
  state.destroyed.assign(destroyed.begin(), destroyed.end());
  state.destroyed_count =
      static_cast<int>(std::count(state.destroyed.begin(), state.destroyed.end(), 1));
  return state;
}

std::vector<std::array<Index, 2>> lips_of(std::span<const SurfaceTriangle> triangles) {
  using Pair = std::array<Index, 2>;
  const auto edges_of = [&](bool opened) {
    std::vector<Pair> edges;
    for (const SurfaceTriangle& t : triangles) {
      if (t.opened != opened) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const Index a = t.nodes[i], b = t.nodes[(i + 1) % 3];
        edges.push_back({std::min(a, b), std::max(a, b)});
      }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
  };
  std::vector<Pair> lips;
  const std::vector<Pair> open = edges_of(true);
  if (open.empty()) return lips;
  const std::vector<Pair> closed = edges_of(false);
  std::set_intersection(open.begin(), open.end(), closed.begin(), closed.end(),
                        std::back_inserter(lips));
  return lips;
}

std::vector<Vec3> normals_of(std::span<const SurfaceTriangle> triangles,
                             std::span<const Vec3> places) {
  std::vector<Vec3> normals(places.size(), Vec3::Zero());
  const auto at = [&](Index n) -> const Vec3& { return places[static_cast<std::size_t>(n)]; };
  for (const SurfaceTriangle& t : triangles) {
    const Vec3& a = at(t.nodes[0]);
    const Vec3 area = (at(t.nodes[1]) - a).cross(at(t.nodes[2]) - a);
    for (const Index n : t.nodes) normals[static_cast<std::size_t>(n)] += area;
  }
  for (Vec3& n : normals) {
    const double length = n.norm();
    if (length > 0) n /= length;
  }
  return normals;
}

Showing::Showing(Simulation& simulation, std::shared_ptr<view::SharedPoints> points)
    : simulation_(simulation),
      points_(std::move(points)),
      plane_(board_plane(simulation.problem().mesh(),
                         simulation.problem().scene().fracture.plane_normal)),
      surface_(simulation) {}

Showing::~Showing() {
  if (points_) points_->leave();  // the simulation goes next
}

std::shared_ptr<Shown> Showing::show(std::uint64_t since) {
  auto shown = std::make_shared<Shown>();
  shown->problem = simulation_.shared_problem();
  shown->state = state_of(simulation_);
  shown->version = surface_.update();
  shown->since = since;
  const auto triangles = surface_.triangles();
  shown->triangles.assign(triangles.begin(), triangles.end());
  if (shown->version != since) shown->changed = surface_.changed_since(since);
  if (shown->version != lips_version_) lips_ = lips_of(triangles);
  lips_version_ = shown->version;
  shown->lips = lips_;
  constexpr double kTrue = 1;
  Pose pose = pose_of(simulation_.problem(), plane_, shown->state, kTrue);
  shown->places = std::move(pose.position);
  // A piece that is cut off is not drawn where the device computes it.
  if (points_ && !pose.loose_piece) shown->points = points_->write(simulation_, surface_);
  if (!shown->points) shown->normals = normals_of(triangles, shown->places);
  shown->tips = simulation_.tips();
  return shown;
}

}  // namespace sunder::app
