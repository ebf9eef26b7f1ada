// SPDX-License-Identifier: Apache-2.0
// Nodal forces and loads of a board, without instruments.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "sunder/backend.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {

/// Everything that a backend can be asked for.
inline Needs all_needs() {
  Needs needs;
  needs.stress = needs.yield = needs.damage = needs.pristine = true;
  return needs;
}

inline std::vector<Index> nodes_in(const Mesh& mesh, const Box& box) {
  std::vector<Index> nodes;
  for (Index n = 0; n < mesh.node_count(); ++n) {
    const Vec3& x = mesh.nodes[n];
    if ((x.array() >= box.min.array()).all() && (x.array() <= box.max.array()).all()) {
      nodes.push_back(n);
    }
  }
  return nodes;
}

/// A force shared equally by some nodes, shape (3 * nodes of the mesh).
inline std::vector<double> shared_force(const Mesh& mesh, const std::vector<Index>& nodes,
                                        const Vec3& force) {
  std::vector<double> nodal(3 * mesh.nodes.size(), 0.0);
  for (Index n : nodes) {
    for (int axis = 0; axis < 3; ++axis) {
      nodal[static_cast<std::size_t>(3 * n + axis)] =
          force[axis] / static_cast<double>(nodes.size());
    }
  }
  return nodal;
}

/// Nodal forces (those at supports are dropped) and the grips' displacements.
inline Load load_of(const Problem& problem, std::span<const double> nodal,
                    std::vector<double> displacements) {
  Load load;
  for (std::size_t i = 0; i < nodal.size(); ++i) {
    const Index d = problem.dofs()[i];
    if (d == kNone || nodal[i] == 0) continue;
    load.force_dofs.push_back(d);
    load.forces.push_back(nodal[i]);
  }
  load.displacements = std::move(displacements);
  return load;
}

/// A force shared equally by some nodes; all grips hold still.
inline Load pull(const Problem& problem, const std::vector<Index>& nodes, const Vec3& force) {
  return load_of(problem, shared_force(problem.mesh(), nodes, force),
                 std::vector<double>(problem.gripped_dofs().size(), 0.0));
}

inline std::vector<double> corner_force(const Mesh& mesh, const Vec3& force = Vec3(0, -60, 0)) {
  return shared_force(mesh, nodes_in(mesh, lower_right_corner()), force);
}

/// The pull of the board's lower right corner.
inline Load corner_pull(const Problem& problem, const Vec3& force = Vec3(0, -60, 0)) {
  return pull(problem, nodes_in(problem.mesh(), lower_right_corner()), force);
}

}  // namespace sunder::test
