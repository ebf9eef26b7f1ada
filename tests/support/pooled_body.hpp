// SPDX-License-Identifier: Apache-2.0
// A body of pooled volume computed anew: what updates along fractures are held against.
#pragma once

#include <algorithm>
#include <stdexcept>
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
  const fem::StressField field(body.problem(), body.scale(), u, body.forms().pools());
  std::vector<Voigt> stress;
  for (Index e = 0; e < body.problem().tet_count(); ++e) {
    stress.push_back(body.scale()[static_cast<std::size_t>(e)] * field.of(e));
  }
  return stress;
}

/// Elements that reach over a height y, and how many patches have elements left on both sides.
struct CutAcross {
  CutAcross(const Problem& problem, double y) : height(y) {
    const auto nodes = [&](Index e, bool above) {
      const auto& tet = problem.mesh().tets[static_cast<std::size_t>(e)];
      return std::ranges::any_of(tet, [&](Index n) {
        return (problem.mesh().nodes[static_cast<std::size_t>(n)].y() >= y) == above;
      });
    };
    for (Index p = 0; p < problem.pools()->count(); ++p) {
      bool above = false, below = false;
      for (Index e : problem.pools()->elements(p)) {
        const bool up = nodes(e, true), down = nodes(e, false);
        if (up && down) elements.push_back(e);
        if (up != down) (up ? above : below) = true;
      }
      shared += above && below ? 1 : 0;
    }
  }
  std::vector<Index> elements;
  int shared = 0;
  double height;
};

/// The lowest of some heights at which such a cut leaves a patch with elements on both sides.
inline CutAcross cut_through_a_patch(const Problem& problem) {
  for (double y = 10; y < 40; y += 0.37) {
    CutAcross cut(problem, y);
    if (cut.shared > 0) return cut;
  }
  throw std::logic_error("no patch reaches over a cut");
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

/// Forces at all nodes that inflate what a cut has left of the patches that it goes through, on the
/// side that is held: of 1 MPa within. `torn`: the body after it.
inline std::vector<double> inflate_beside(const CutAcross& cut, const fem::DamagedBody& torn) {
  const Problem& problem = torn.problem();
  const std::vector<std::uint8_t> loose = not_attached(torn);
  std::vector<Index> patches;
  problem.pools()->of(cut.elements, patches);
  std::vector<double> force(problem.dofs().size(), 0.0);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const auto at = static_cast<std::size_t>(e);
    if (loose[at] || !std::ranges::binary_search(patches, problem.pools()->of(e))) continue;
    const TetShape& shape = problem.shape(e);
    for (std::size_t i = 0; i < 12; ++i) {
      const auto n = static_cast<std::size_t>(problem.mesh().tets[at][i / 3]);
      force[3 * n + i % 3] +=
          shape.volume * shape.gradient(static_cast<Index>(i % 3), static_cast<Index>(i / 3));
    }
  }
  return force;
}

}  // namespace sunder::test
