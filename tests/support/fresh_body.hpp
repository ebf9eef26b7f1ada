// SPDX-License-Identifier: Apache-2.0
// The state of a live simulation computed anew by the yardstick: what is gripped where it is, all
// else follows.
#pragma once

#include <memory>
#include <vector>

#include "cpu_reference/plain/finite.hpp"
#include "sunder/simulation.hpp"
#include "support/accuracy.hpp"
#include "support/loads.hpp"
#include "support/yardstick.hpp"

namespace sunder::test {

struct FreshBody {
  /// `force`: nodal forces that act in it (3 * nodes).
  FreshBody(const Simulation& of, std::span<const double> force)
      : problem(of.problem(), of.backend().gripped_dofs()), moved(of.displacement()) {
    for (const Vec3& v : moved) u.insert(u.end(), v.data(), v.data() + 3);
    std::vector<double> held;
    for (Index d : problem.gripped_dofs()) {
      const auto at = std::ranges::find(problem.dofs(), d) - problem.dofs().begin();
      held.push_back(u[static_cast<std::size_t>(at)]);
    }
    const auto destroyed = of.backend().destroyed();
    if (problem.finite() || problem.fibrous()) {
      solution =
          plain::FiniteBody(problem, destroyed).solve(load_of(problem, force, std::move(held)), u);
    } else {
      solution = yardstick(problem, destroyed, force, std::move(held));
    }
    for (Index e = 0; e < problem.tet_count(); ++e) {
      left_out.push_back(destroyed[e] || of.piece_of(e) != kNone);
    }
  }

  /// 2-norm over the nodes of what is live and held.
  [[nodiscard]] double error() const {
    return displacement_error(problem.mesh(), left_out, u, solution.displacement);
  }
  /// What grips of these nodes exert, about a place.
  [[nodiscard]] Wrench wrench(std::span<const Index> nodes, const Vec3& about) const {
    Wrench felt;
    for (Index n : nodes) {
      Vec3 force;
      for (int axis = 0; axis < 3; ++axis) {
        const auto gripped = problem.gripped_dofs();
        const auto g = std::ranges::lower_bound(gripped, problem.dof(n, axis)) - gripped.begin();
        force[axis] = solution.reactions[static_cast<std::size_t>(g)];
      }
      const auto at = static_cast<std::size_t>(n);
      felt.force += force;
      felt.torque += Vec3(problem.mesh().nodes[at] + moved[at] - about).cross(force);
    }
    return felt;
  }

  Problem problem;
  std::vector<Vec3> moved;
  std::vector<double> u;  // of the simulation
  plain::Solution solution;
  std::vector<std::uint8_t> left_out;
};

/// Of instruments that pull by a force of their own, fully from the start, and pushes.
inline void add_force(const Mesh& mesh, std::span<const Index> nodes, const Vec3& force,
                      std::vector<double>& to) {
  const auto share = shared_force(mesh, {nodes.begin(), nodes.end()}, force);
  to.resize(share.size(), 0.0);
  for (std::size_t i = 0; i < share.size(); ++i) to[i] += share[i];
}

}  // namespace sunder::test
