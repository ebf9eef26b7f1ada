// SPDX-License-Identifier: Apache-2.0
// Stiffness and update vectors in the form that CHOLMOD takes.
#pragma once

#include <cholmod.h>

#include <algorithm>
#include <span>
#include <vector>

#include "body/assembly.hpp"
#include "body/event_factor.hpp"
#include "sunder/problem.hpp"

namespace sunder::bench {

/// A copy; `stype` -1: only the lower triangle of a symmetric matrix is stored.
inline cholmod_sparse* to_cholmod(const linear_algebra::SparseMatrix& m, int stype,
                                  cholmod_common& common) {
  cholmod_sparse* s = cholmod_allocate_sparse(
      static_cast<std::size_t>(m.rows()), static_cast<std::size_t>(m.cols()),
      static_cast<std::size_t>(m.nonZeros()), 1, 1, stype, CHOLMOD_REAL, &common);
  std::copy_n(m.outerIndexPtr(), m.cols() + 1, static_cast<int*>(s->p));
  std::copy_n(m.innerIndexPtr(), m.nonZeros(), static_cast<int*>(s->i));
  std::copy_n(m.valuePtr(), m.nonZeros(), static_cast<double*>(s->x));
  return s;
}

/// Stiffness with some elements destroyed, lower triangle.
inline linear_algebra::SparseMatrix damaged_stiffness(const Problem& problem,
                                                      std::span<const Index> destroyed) {
  std::vector<double> scale(problem.mesh().tets.size(), 1.0);
  for (Index e : destroyed) {
    scale[static_cast<std::size_t>(e)] = problem.scene().fracture.alpha;
  }
  return fem::assemble_lower(problem, scale);
}

/// W with K - W W^T the stiffness after the elements are destroyed, six columns each. `order`: the
/// unknown that comes at each row (a factor's Perm); empty: the unknowns' own order.
inline linear_algebra::SparseMatrix update_columns(const Problem& problem,
                                                   std::span<const Index> elements,
                                                   std::span<const int> order) {
  const auto n = static_cast<std::size_t>(problem.dof_count());
  std::vector<Index> place(n);
  for (std::size_t i = 0; i < n; ++i) {
    place[order.empty() ? i : static_cast<std::size_t>(order[i])] = static_cast<Index>(i);
  }
  std::vector<Eigen::Triplet<double, Index>> entries;
  Index column = 0;
  for (const Index& e : elements) {
    const fem::EventFactor one = fem::event_factor(problem, {&e, 1});
    for (Eigen::Index j = 0; j < 6; ++j, ++column) {
      for (std::size_t i = 0; i < one.dofs.size(); ++i) {
        const double value = one.w(static_cast<Eigen::Index>(i), j);
        if (value != 0) {
          entries.emplace_back(place[static_cast<std::size_t>(one.dofs[i])], column, value);
        }
      }
    }
  }
  linear_algebra::SparseMatrix w(problem.dof_count(), column);
  w.setFromTriplets(entries.begin(), entries.end());
  return w;
}

inline std::span<const int> order_of(const cholmod_factor& factor) {
  return {static_cast<const int*>(factor.Perm), factor.n};
}

}  // namespace sunder::bench
