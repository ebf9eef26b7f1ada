// SPDX-License-Identifier: Apache-2.0
#include "solver/load_room.hpp"

#include <algorithm>

namespace sunder::solver {

std::size_t most_forces(const Problem& problem) {
  constexpr std::size_t kPressed = 2, kElement = 12;  // nodes of a press, unknowns of an element
  std::size_t sum = 0;
  for (const InstrumentNodes& i : problem.instrument_nodes()) {
    sum += 3 * std::max(i.nodes.size(), kPressed);
  }
  if (!problem.scene().gravity.isZero(0)) sum = static_cast<std::size_t>(problem.dof_count());
  return std::max(sum, kElement);
}

void reserve(Load& load, const Problem& problem) {
  load.force_dofs.reserve(most_forces(problem));
  load.forces.reserve(most_forces(problem));
  load.displacements.reserve(problem.gripped_dofs().size());
}

}  // namespace sunder::solver
