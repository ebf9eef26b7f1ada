// SPDX-License-Identifier: Apache-2.0
// What a host takes hold of the body by, or pushes it with, at run time.
#pragma once

#include <span>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder {

struct Tool {
  int id = 0;          ///< after those of the scene's instruments, none twice
  bool holds = false;  ///< a grip; else a push
  bool rigid = false;  ///< of a grip: it turns its nodes with it
  std::vector<Index> nodes;
  Vec3 force = Vec3::Zero();  ///< of a push, in equal parts on its nodes [N]

  std::size_t first = 0;  ///< of a grip: the place of its first unknown in a load's displacements
  // Of a grip: where it took hold, and of each node the displacement then and the place from there.
  Vec3 centre = Vec3::Zero();
  std::vector<Vec3> moved, arms;
  // Where it is now: from `centre`, and R - I.
  Vec3 shift = Vec3::Zero();
  Mat3 turn = Mat3::Zero();
  Mat3 turn_at_load = Mat3::Zero();  ///< in the last solution: what its forces belong to

  /// Displacement of a node that it prescribes now; exactly that of then where it has not moved.
  [[nodiscard]] Vec3 displacement(std::size_t node) const {
    return moved[node] + shift + turn * arms[node];
  }
};

/// Unknowns of a grip, node by node and axis by axis.
[[nodiscard]] inline std::vector<Index> dofs_of(const Tool& tool, const Problem& problem) {
  std::vector<Index> dofs;
  for (Index n : tool.nodes) {
    for (int axis = 0; axis < 3; ++axis) dofs.push_back(problem.dof(n, axis));
  }
  return dofs;
}

}  // namespace sunder
