// SPDX-License-Identifier: Apache-2.0
// A body of pooled volume computed anew: what updates along fractures are held against.
#pragma once

#include <vector>

#include "body/assembly.hpp"
#include "body/damaged_body.hpp"
#include "body/pieces.hpp"
#include "body/pools.hpp"
#include "body/stiffness_factor.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {

/// Pulled at a corner, all of it pooled.
inline Scene pooled_board(double nu) {
  Scene scene = pulled_board();
  set_poisson(scene, nu);
  for (auto& [name, material] : scene.materials) material.volume = MaterialVolume::pooled;
  return scene;
}

/// Force at all nodes [N].
inline std::vector<double> pull_at_corner(const Problem& problem) {
  std::vector<double> force(problem.dofs().size(), 0.0);
  for (Index n : problem.instrument_nodes()[0].nodes) {
    force[3 * static_cast<std::size_t>(n) + 1] = -30;
  }
  return force;
}

/// Of a displacement at all nodes, destroyed elements with their share.
inline std::vector<Voigt> pooled_stress(const fem::DamagedBody& body, std::span<const double> u) {
  const fem::StressField field(body.problem(), body.scale(), u);
  std::vector<Voigt> stress;
  for (Index e = 0; e < body.problem().tet_count(); ++e) {
    stress.push_back(body.scale()[static_cast<std::size_t>(e)] * field.of(e));
  }
  return stress;
}

/// By a factor of the body as it is, refined twice.
struct FreshSolution {
  FreshSolution(const fem::DamagedBody& body, std::span<const double> force) {
    const Problem& problem = body.problem();
    const linear_algebra::Factor factor = fem::factor_stiffness(body);
    Eigen::VectorXd f(problem.dof_count()), u = Eigen::VectorXd::Zero(f.size()), r = f, du;
    fem::gather(problem, force, {f.data(), static_cast<std::size_t>(f.size())});
    linear_algebra::SolveWork work;
    for (int pass = 0; pass < 3; ++pass) {
      body.apply(u, r);
      r = f - r;
      factor.solve(r, du, work);
      u += du;
    }
    displacement.resize(problem.dofs().size());
    fem::scatter(problem, {u.data(), static_cast<std::size_t>(u.size())}, displacement);
    stress = pooled_stress(body, displacement);
  }
  std::vector<double> displacement;
  std::vector<Voigt> stress;
};

/// Destroyed, or in a piece that hangs on nothing.
inline std::vector<std::uint8_t> not_attached(const fem::DamagedBody& body) {
  std::vector<std::uint8_t> out(body.destroyed().begin(), body.destroyed().end());
  for (const auto& piece : find_loose_parts(body.problem(), out).pieces) {
    for (Index e : piece) out[static_cast<std::size_t>(e)] = 1;
  }
  return out;
}

}  // namespace sunder::test
