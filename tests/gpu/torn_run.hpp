// SPDX-License-Identifier: Apache-2.0
// The board of pulled_until_it_tears() run to its end, in one way or another.
#pragma once

#include <vector>

#include "gpu_body.hpp"
#include "tearing_board.hpp"

namespace sunder::test {

struct TornRun {
  std::vector<Index> destroyed;
  std::vector<Vec3> displacement;
  std::vector<Voigt> stress;
};

/// `groups`: workgroups along x that the device claims to take; 0: as it says.
inline TornRun tear(const Way& way, std::uint64_t groups = 0) {
  WatchedBackend watched(pulled_until_it_tears(), way);
  watched.options.probe.limits.groups = groups;
  Simulation simulation(watched.problem, watched.create());
  while (!simulation.done()) simulation.step();
  TornRun torn;
  for (const DestroyedElement& d : simulation.destroyed()) torn.destroyed.push_back(d.element);
  torn.displacement = simulation.displacement();
  torn.stress = simulation.stress();
  return torn;
}

}  // namespace sunder::test
