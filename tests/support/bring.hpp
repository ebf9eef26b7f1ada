// SPDX-License-Identifier: Apache-2.0
// A grip is brought to a pose, of whatever kind it is.
#pragma once

#include "sunder/error.hpp"
#include "sunder/simulation.hpp"

namespace sunder::test {

/// A grip of points does not turn: it goes to the place alone.
inline void bring(Simulation& simulation, int grip, const Pose& to) {
  try {
    simulation.pose(grip, to);
  } catch (const UsageError&) {
    simulation.pose(grip, {to.position});
  }
}

}  // namespace sunder::test
