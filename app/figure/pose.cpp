// SPDX-License-Identifier: Apache-2.0
#include "app/figure/pose.hpp"

#include <algorithm>
#include <cmath>

#include "sunder/loose_parts.hpp"

namespace sunder::app {
namespace {

// Shares of the body's longest side: below the first, displacements are magnified to the second;
// above the third they are reduced to the fourth; a cut-off piece is drawn at most the last away.
// Below kRounding nothing moves.
constexpr double kInvisible = 0.004, kMagnified = 0.06, kAbsurd = 1, kReduced = 0.6,
                 kLooseShift = 0.12, kRounding = 1e-10;
constexpr int kSmoothing = 30;  // sweeps; isolated nodes lie a few elements deep at most

/// Per node: held by the body, part of a cut-off piece, or held by destroyed elements only.
enum class Hold : std::uint8_t { firm, loose, isolated };

std::vector<Hold> holds_of(const Mesh& mesh, const LooseParts& parts) {
  std::vector<Hold> holds(mesh.nodes.size(), Hold::firm);
  for (const auto& piece : parts.pieces)
    for (const Index e : piece)
      for (const Index node : mesh.tets[e]) holds[node] = Hold::loose;
  for (const Index node : parts.isolated_nodes) holds[node] = Hold::isolated;
  return holds;
}

double largest_in_plane(const BoardPlane& plane, const std::vector<Hold>& holds,
                        const State& state) {
  double largest = 0;
  for (std::size_t node = 0; node < holds.size(); ++node)
    if (holds[node] == Hold::firm)
      largest = std::max(largest, plane.project(state.displacement[node]).norm());
  return largest;
}

/// Nearest of 1, 2, 5 times a power of ten, so that a caption can state it.
double round_125(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  const double lead = x / power;
  return (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10) * power;
}

double scale_for(double largest, double side) {
  const double share = largest / side;
  if (!(share > kRounding) || !std::isfinite(share)) return 1;
  if (share < kInvisible) return round_125(kMagnified / share);
  return share > kAbsurd ? round_125(kReduced / share) : 1;
}

/// A cut-off piece moves as a whole: its mean displacement, shortened to what fits the picture.
void shift_piece(Pose& pose, const Mesh& mesh, const std::vector<Index>& piece, const State& state,
                 double side) {
  std::vector<Index> nodes;
  for (const Index e : piece) nodes.insert(nodes.end(), mesh.tets[e].begin(), mesh.tets[e].end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  Vec3 shift = Vec3::Zero();
  for (const Index node : nodes) shift += state.displacement[node];
  shift *= pose.scale / static_cast<double>(nodes.size());
  const double limit = kLooseShift * side;
  if (shift.norm() > limit) shift *= limit / shift.norm();
  for (const Index node : nodes) pose.shift[node] = shift;
}

/// Isolated nodes: the mean of their neighbours', by Jacobi sweeps from the live ones inwards.
void follow_neighbours(Pose& pose, const Mesh& mesh, const std::vector<Hold>& holds,
                       const std::vector<std::uint8_t>& destroyed) {
  const auto isolated = [&](Index node) { return holds[node] == Hold::isolated; };
  std::vector<Index> elements;
  for (Index e = 0; e < mesh.tet_count(); ++e)
    if (destroyed[e] && std::any_of(mesh.tets[e].begin(), mesh.tets[e].end(), isolated))
      elements.push_back(e);
  if (elements.empty()) return;
  std::vector<std::uint8_t> known(holds.size());
  for (std::size_t node = 0; node < holds.size(); ++node)
    known[node] = holds[node] != Hold::isolated;
  std::vector<Vec3> sum(holds.size());
  std::vector<int> count(holds.size());
  for (int sweep = 0; sweep < kSmoothing; ++sweep) {
    std::fill(sum.begin(), sum.end(), Vec3::Zero());
    std::fill(count.begin(), count.end(), 0);
    for (const Index e : elements)
      for (const Index to : mesh.tets[e])
        for (const Index from : mesh.tets[e]) {
          if (!isolated(to) || to == from || !known[from]) continue;
          sum[to] += pose.shift[from];
          ++count[to];
        }
    for (std::size_t node = 0; node < holds.size(); ++node)
      if (count[node] > 0) {
        pose.shift[node] = sum[node] / count[node];
        known[node] = 1;
      }
  }
}

}  // namespace

Pose pose_of(const Problem& problem, const BoardPlane& plane, const State& state,
             std::optional<double> scale) {
  const Mesh& mesh = mesh_of(problem, state);
  const std::vector<Vec3>& rest = state.split ? state.split->drawn : mesh.nodes;
  const LooseParts parts = find_loose_parts(problem, state.destroyed, mesh);
  const std::vector<Hold> holds = holds_of(mesh, parts);
  const double side = (plane.outline_max - plane.outline_min).maxCoeff();
  Pose pose;
  pose.scale = scale ? *scale : scale_for(largest_in_plane(plane, holds, state), side);
  pose.loose_piece = !parts.pieces.empty();
  pose.shift.assign(mesh.nodes.size(), Vec3::Zero());
  if (problem.moves()) {  // pieces are where they are
    pose.scale = 1;
    pose.loose_piece = false;
    pose.shift = state.displacement;
    pose.position.resize(mesh.nodes.size());
    for (std::size_t node = 0; node < holds.size(); ++node)
      pose.position[node] = rest[node] + pose.shift[node];
    return pose;
  }
  for (std::size_t node = 0; node < holds.size(); ++node)
    if (holds[node] == Hold::firm) pose.shift[node] = state.displacement[node] * pose.scale;
  for (const auto& piece : parts.pieces) shift_piece(pose, mesh, piece, state, side);
  follow_neighbours(pose, mesh, holds, state.destroyed);
  pose.position.resize(mesh.nodes.size());
  for (std::size_t node = 0; node < holds.size(); ++node)
    pose.position[node] = rest[node] + pose.shift[node];
  return pose;
}

}  // namespace sunder::app
