// SPDX-License-Identifier: Apache-2.0
#include "body/assembly.hpp"

#include <algorithm>
#include <vector>

#include "body/element.hpp"
#include "body/pools.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::fem {
namespace {

void add_element(const Problem& problem, const std::array<Index, 4>& corners,
                 const ElementMatrix& k, std::vector<Eigen::Triplet<double, Index>>& triplets) {
  std::array<Index, 12> dofs;
  for (int i = 0; i < 12; ++i) dofs[i] = problem.dof(corners[i / 3], i % 3);
  for (int j = 0; j < 12; ++j) {
    for (int i = 0; i < 12; ++i) {
      if (dofs[j] == kNone || dofs[i] < dofs[j]) continue;  // kNone < every dof
      triplets.emplace_back(dofs[i], dofs[j], k(i, j));
    }
  }
}

}  // namespace

linear_algebra::SparseMatrix assemble_elements(
    const Problem& problem, const std::function<ElementMatrix(Index)>& matrix_of) {
  std::vector<Eigen::Triplet<double, Index>> triplets;
  triplets.reserve(static_cast<std::size_t>(problem.tet_count()) * 78);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    add_element(problem, problem.mesh().tets[e], matrix_of(e), triplets);
  }
  for (Index dof : problem.anchored_dofs()) {
    triplets.emplace_back(dof, dof, problem.anchor_stiffness());
  }
  linear_algebra::SparseMatrix matrix(problem.dof_count(), problem.dof_count());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

linear_algebra::SparseMatrix assemble_lower(const Problem& problem, std::span<const double> scale,
                                            const Pools* pools) {
  linear_algebra::SparseMatrix lower = assemble_elements(problem, [&](Index e) {
    ElementMatrix k = element_stiffness(problem, e);
    if (!scale.empty()) k *= scale[e];
    return k;
  });
  if (problem.pools()) lower += assemble_pressure(problem, scale, pools);
  return lower;
}

linear_algebra::SparseMatrix assemble_forms(const Problem& problem, std::span<const Form> forms) {
  std::vector<Eigen::Triplet<double, Index>> triplets;
  for (const Form& form : forms) {
    const ElementMatrix k = form.share * element_stiffness(form.shape, elasticity(form.law));
    add_element(problem, form.corners, k, triplets);
  }
  linear_algebra::SparseMatrix matrix(problem.dof_count(), problem.dof_count());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

void apply_stiffness(const Problem& problem, std::span<const double> scale,
                     std::span<const double> u, std::span<double> y, const Pools* pools) {
  std::fill(y.begin(), y.end(), 0.0);
  const StressField field(problem, scale, u, pools);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const TetShape& shape = problem.shape(e);
    const Voigt s = field.of(e);
    const double weight = shape.volume * (scale.empty() ? 1.0 : scale[e]);
    const Eigen::Matrix<double, 3, 4> force = weight * (tensor(s) * shape.gradient);
    for (int a = 0; a < 4; ++a) {
      const Index n = problem.mesh().tets[e][a];
      for (int axis = 0; axis < 3; ++axis) y[3 * n + axis] += force(axis, a);
    }
  }
}

void scatter(const Problem& problem, std::span<const double> unknowns, std::span<double> nodal) {
  const auto dofs = problem.dofs();
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    nodal[i] = dofs[i] == kNone ? 0.0 : unknowns[dofs[i]];
  }
}

void gather(const Problem& problem, std::span<const double> nodal, std::span<double> unknowns) {
  const auto dofs = problem.dofs();
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    if (dofs[i] != kNone) unknowns[dofs[i]] = nodal[i];
  }
}

}  // namespace sunder::fem
