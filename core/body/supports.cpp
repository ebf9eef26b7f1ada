// SPDX-License-Identifier: Apache-2.0
#include "body/supports.hpp"

#include <Eigen/Eigenvalues>
#include <numeric>

namespace sunder::fem {
namespace {

// Relative to the largest eigenvalue of the scaled Gram matrix of rigid modes at held dofs.
constexpr double kRigidTolerance = 1e-10;

Index root_of(std::vector<Index>& parent, Index n) {
  while (parent[n] != n) {
    parent[n] = parent[parent[n]];
    n = parent[n];
  }
  return n;
}

}  // namespace

int rigid_modes_left(const Mesh& mesh, std::span<const HeldDof> held) {
  if (held.empty()) return 6;
  Vec3 center = Vec3::Zero();
  for (const HeldDof& h : held) center += mesh.nodes[h.node];
  center /= static_cast<double>(held.size());
  double size = 0;
  for (const HeldDof& h : held) size = std::max(size, (mesh.nodes[h.node] - center).norm());
  if (!(size > 0)) size = 1;
  Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  for (const HeldDof& h : held) {
    const Vec3 x = (mesh.nodes[h.node] - center) / size;
    Eigen::Matrix<double, 6, 1> row;
    row << Vec3::Unit(h.axis), x.cross(Vec3::Unit(h.axis));
    gram += row * row.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(gram,
                                                                          Eigen::EigenvaluesOnly);
  const auto& values = solver.eigenvalues();
  return static_cast<int>((values.array() <= kRigidTolerance * values[5]).count());
}

std::vector<HeldDof> missing_supports(const Mesh& mesh, std::span<const HeldDof> held,
                                      std::span<const Index> nodes) {
  Vec3 center = Vec3::Zero();
  for (Index n : nodes) center += mesh.nodes[n] / static_cast<double>(nodes.size());
  double size = 0;
  for (Index n : nodes) size = std::max(size, (mesh.nodes[n] - center).norm());
  for (const HeldDof& h : held) size = std::max(size, (mesh.nodes[h.node] - center).norm());
  const auto row = [&](const HeldDof& d) {
    const Vec3 x = (mesh.nodes[d.node] - center) / size;
    Eigen::Matrix<double, 6, 1> motion;
    motion << Vec3::Unit(d.axis), x.cross(Vec3::Unit(d.axis));
    return motion;
  };
  Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  for (const HeldDof& h : held) gram += row(h) * row(h).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(gram);
  const auto& values = solver.eigenvalues();
  const auto left = (values.array() <= kRigidTolerance * values[5]).count();
  Eigen::MatrixXd modes = solver.eigenvectors().leftCols(left);
  std::vector<HeldDof> missing;
  for (Eigen::Index m = 0; m < left; ++m) {
    HeldDof best{kNone, 0};
    Eigen::VectorXd moves = Eigen::VectorXd::Zero(left);
    for (Index n : nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::VectorXd of = modes.transpose() * row({n, axis});
        if (!(of.squaredNorm() > moves.squaredNorm() * (1 + 1e-9))) continue;  // ties: the first
        moves = of;
        best = {n, axis};
      }
    }
    if (best.node == kNone) break;
    missing.push_back(best);
    modes -= (modes * moves) * moves.transpose() / moves.squaredNorm();
  }
  return missing;
}

void find_bodies(const Mesh& mesh, std::span<const std::uint8_t> exclude, Bodies& bodies,
                 BodyRoom& room) {
  std::vector<Index>& parent = room.parent;
  parent.resize(mesh.nodes.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto included = [&](Index e) { return exclude.empty() || !exclude[e]; };
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    if (!included(e)) continue;
    const Index root = root_of(parent, mesh.tets[e][0]);
    for (int a = 1; a < 4; ++a) parent[root_of(parent, mesh.tets[e][a])] = root;
  }
  bodies.count = 0;
  bodies.body_of_element.assign(mesh.tets.size(), kNone);
  bodies.body_of_node.assign(mesh.nodes.size(), kNone);
  room.number.assign(mesh.nodes.size(), kNone);
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    if (!included(e)) continue;
    Index& body = room.number[root_of(parent, mesh.tets[e][0])];
    if (body == kNone) body = bodies.count++;
    bodies.body_of_element[e] = body;
    for (Index n : mesh.tets[e]) bodies.body_of_node[n] = body;
  }
}

Bodies find_bodies(const Mesh& mesh, std::span<const std::uint8_t> exclude) {
  Bodies bodies;
  BodyRoom room;
  find_bodies(mesh, exclude, bodies, room);
  return bodies;
}

}  // namespace sunder::fem
