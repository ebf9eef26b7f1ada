// SPDX-License-Identifier: Apache-2.0
// Random live actions: every now and then the state is computed anew and the recording of all of
// them leads another simulation to the same bits.
#pragma once

#include "core/frame/live_hand.hpp"
#include "core/frame/run_state.hpp"

namespace sunder::test {

struct Played {
  int checked = 0, recorded = 0, grasped = 0, posed = 0, released = 0, removed = 0, back = 0,
      own = 0;
};

/// Checks after so many actions, and the recording after so many checks.
inline Played play_at_random(const std::shared_ptr<const Problem>& problem,
                             const LiveRun::Make& make, unsigned seed, int actions, int check,
                             int record, double tolerance) {
  LiveRun run(problem, make);
  run.keep_history();
  LiveHand hand(run, seed);
  Played played;
  for (int i = 1; i <= actions && !testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE(i);
    hand.act();
    if (i % check != 0) continue;
    try {
      run.simulation.step();
    } catch (const NumericalError&) {
      continue;
    }
    ++played.checked;
    const FreshBody fresh = run.fresh();
    // The accuracy table: scattered, a crack, a cut.
    const bool cut = std::ranges::any_of(fresh.left_out, [](std::uint8_t out) { return out != 0; });
    EXPECT_LE(fresh.error(), cut ? std::max(tolerance, kCutTolerance) : tolerance);
    if (played.checked % record != 0) continue;
    ++played.recorded;
    LiveRun other(problem, make);
    other.keep_history();
    other.simulation.load(run.simulation.store());
    expect_same_bits(RunState(other.simulation), RunState(run.simulation));
  }
  EXPECT_LE(hand.failed, actions / 10);
  played.grasped = hand.grasped;
  played.posed = hand.posed;
  played.released = hand.released;
  played.removed = hand.removed;
  played.back = hand.back;
  played.own = hand.own;
  return played;
}

inline Played play_at_random(const Scene& scene, unsigned seed, int actions, int check,
                             int record) {
  const auto problem = std::make_shared<const Problem>(scene);
  return play_at_random(
      problem, [problem] { return cpu_reference::create(problem, needs_of(*problem)); }, seed,
      actions, check, record, kCrackTolerance);
}

}  // namespace sunder::test
