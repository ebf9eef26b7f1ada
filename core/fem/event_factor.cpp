// SPDX-License-Identifier: Apache-2.0
#include "fem/event_factor.hpp"

#include <algorithm>

#include "fem/element.hpp"

namespace sunder::fem {

EventFactor event_factor(const Problem& problem, std::span<const Index> elements) {
  EventFactor event;
  for (Index e : elements) {
    for (Index n : problem.mesh().tets[e]) {
      for (int axis = 0; axis < 3; ++axis) {
        if (problem.dof(n, axis) != kNone) event.dofs.push_back(problem.dof(n, axis));
      }
    }
  }
  std::sort(event.dofs.begin(), event.dofs.end());
  event.dofs.erase(std::unique(event.dofs.begin(), event.dofs.end()), event.dofs.end());
  event.w.setZero(static_cast<Index>(event.dofs.size()), 6 * static_cast<Index>(elements.size()));
  Index column = 0;
  for (Index e : elements) {
    const Material& m = problem.material(e);
    const UpdateFactor u = update_factor(problem.shape(e), elasticity(m.young, m.poisson),
                                         problem.scene().fracture.alpha);
    for (int i = 0; i < 12; ++i) {
      const Index dof = problem.dof(problem.mesh().tets[e][i / 3], i % 3);
      if (dof == kNone) continue;
      const auto row = std::lower_bound(event.dofs.begin(), event.dofs.end(), dof);
      event.w.block<1, 6>(row - event.dofs.begin(), column) = u.row(i);
    }
    column += 6;
  }
  return event;
}

}  // namespace sunder::fem
