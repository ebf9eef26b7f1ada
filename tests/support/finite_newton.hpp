// SPDX-License-Identifier: Apache-2.0
// Newton's method with a factor of the exact tangent each iteration, from a state close by: what
// the solvers of finite statics are held against where the yardstick would take too long.
#pragma once

#include <algorithm>
#include <vector>

#include "body/hyperelastic.hpp"
#include "body/stiffness_factor.hpp"
#include "sunder/backend.hpp"
#include "support/assembled_tangent.hpp"

namespace sunder::test {

struct NewtonRest {
  std::vector<double> u;
  double residual = 0;  ///< |r| of free unknowns over |internal forces|
  int factors = 0;
};

/// `body` must not have pieces that nothing holds. Until the residual is at rounding, at most
/// twelve factors; throws NumericalError where the tangent is indefinite.
inline NewtonRest newton(const fem::HyperelasticBody& body, const Load& load,
                         std::vector<double> u) {
  const Problem& problem = body.problem;
  const std::vector<Index> order = fem::elimination_order(problem);
  std::vector<std::uint8_t> known(static_cast<std::size_t>(problem.dof_count()), 0);
  for (Index d : problem.gripped_dofs()) known[d] = 1;
  NewtonRest rest{std::move(u), 0, 0};
  std::vector<double> f(rest.u.size());
  for (double least = 1e300;;) {
    fem::internal_forces(body, rest.u, f);
    Eigen::VectorXd r = Eigen::VectorXd::Zero(problem.dof_count());
    for (std::size_t i = 0; i < load.forces.size(); ++i) r[load.force_dofs[i]] -= load.forces[i];
    double acting = 0;
    linear_algebra::SparseMatrix k = assemble_tangent(body, rest.u, fem::Tangent::exact);
    for (std::size_t i = 0; i < f.size(); ++i) {
      acting += f[i] * f[i];
      if (problem.dofs()[i] != kNone) r[problem.dofs()[i]] += f[i];
    }
    std::vector<std::uint8_t> still = known;  // what no live element reaches too
    {
      std::vector<std::uint8_t> reached(still.size(), 0);
      for (Index e = 0; e < problem.tet_count(); ++e) {
        if (!body.live(e)) continue;
        for (Index n : problem.mesh().tets[e])
          for (int axis = 0; axis < 3; ++axis)
            if (problem.dof(n, axis) != kNone) reached[problem.dof(n, axis)] = 1;
      }
      for (std::size_t d = 0; d < still.size(); ++d) still[d] |= !reached[d];
    }
    for (Index d = 0; d < r.size(); ++d) {
      if (still[d]) r[d] = 0;
    }
    rest.residual = r.norm() / std::sqrt(acting);
    const bool stalls = least < 1e-10 && !(rest.residual < 0.5 * least);  // at rounding
    if (rest.residual < 1e-13 || stalls || rest.factors == 12) return rest;
    least = rest.residual;
    for (Index c = 0; c < k.cols(); ++c) {
      for (linear_algebra::SparseMatrix::InnerIterator it(k, c); it; ++it) {
        if (still[it.row()] || still[c]) it.valueRef() = it.row() == c ? 1 : 0;
      }
    }
    const Eigen::VectorXd du = linear_algebra::Factor(k, order).solve(-r);
    ++rest.factors;
    for (std::size_t i = 0; i < f.size(); ++i) {
      if (problem.dofs()[i] != kNone) rest.u[i] += du[problem.dofs()[i]];
    }
  }
}

}  // namespace sunder::test
