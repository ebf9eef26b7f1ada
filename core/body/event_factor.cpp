// SPDX-License-Identifier: Apache-2.0
#include "body/event_factor.hpp"

#include <algorithm>

#include "body/element.hpp"
#include "linear_algebra/row_product.hpp"

namespace sunder::fem {
namespace {

/// Unknowns that elements touch, ascending.
void touched_by(const Problem& problem, std::span<const Index> elements, std::vector<Index>& dofs) {
  dofs.clear();
  for (Index e : elements) {
    for (Index n : problem.mesh().tets[e]) {
      for (int axis = 0; axis < 3; ++axis) {
        if (problem.dof(n, axis) != kNone) dofs.push_back(problem.dof(n, axis));
      }
    }
  }
  std::sort(dofs.begin(), dofs.end());
  dofs.erase(std::unique(dofs.begin(), dofs.end()), dofs.end());
}

}  // namespace

void event_factor(const Problem& problem, std::span<const Index> elements, Eigen::Index stride,
                  std::vector<Index>& dofs, std::vector<double>& w) {
  touched_by(problem, elements, dofs);
  const std::size_t size = dofs.size() * static_cast<std::size_t>(stride);
  if (w.size() < size) w.resize(size);
  Eigen::Map<linear_algebra::RowMajor> rows(w.data(), static_cast<Eigen::Index>(dofs.size()),
                                            stride);
  rows.setZero();
  Eigen::Index column = 0;
  for (Index e : elements) {
    const UpdateFactor u = update_factor(problem, e);
    for (int i = 0; i < 12; ++i) {
      const Index dof = problem.dof(problem.mesh().tets[e][i / 3], i % 3);
      if (dof == kNone) continue;
      const auto row = std::lower_bound(dofs.begin(), dofs.end(), dof);
      rows.block<1, 6>(row - dofs.begin(), column) = u.row(i);
    }
    column += 6;
  }
}

EventFactor event_factor(const Problem& problem, std::span<const Index> elements) {
  EventFactor event;
  std::vector<double> w;
  const auto columns = 6 * static_cast<Eigen::Index>(elements.size());
  event_factor(problem, elements, columns, event.dofs, w);
  event.w = Eigen::Map<linear_algebra::RowMajor>(
      w.data(), static_cast<Eigen::Index>(event.dofs.size()), columns);
  return event;
}

}  // namespace sunder::fem
