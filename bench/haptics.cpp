// SPDX-License-Identifier: Apache-2.0
// What a hand feels, millisecond by millisecond, while it pulls a board apart: the largest change
// of force in one of them, at once and blended. By times of its own, 10 ms a frame: the figures do
// not depend on the machine.   bench_haptics [TRACE.csv]
#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"
#include "tearing_board.hpp"

namespace {

using namespace sunder;
using bench::TearingBoard;

constexpr int kFrame = 10, kRuptures = 50, kMost = 20000;  // ms, events, ms
constexpr double kSpeed = 0.005;                           // of the hand [mm/ms]

struct Trace {
  struct Tick {
    Vec3 force;
    int ruptures;  ///< so far
    double share;  ///< of the newest solution
  };
  std::vector<Tick> ticks;
  int held = 0;  ///< nodes

  /// Largest change in a millisecond: in those in which a rupture is felt (or blended in), and in
  /// the others.
  [[nodiscard]] std::array<double, 2> largest() const {
    std::array<double, 2> most{0, 0};
    for (std::size_t t = 1; t < ticks.size(); ++t) {
      const bool torn = ticks[t].ruptures > ticks[t - 1].ruptures ||
                        std::min(ticks[t].share, ticks[t - 1].share) < 1;
      double& of = most[torn ? 0 : 1];
      of = std::max(of, (ticks[t].force - ticks[t - 1].force).norm());
    }
    return most;
  }
  [[nodiscard]] double strongest() const {
    double most = 0;
    for (const Tick& tick : ticks) most = std::max(most, tick.force.norm());
    return most;
  }
};

/// One event a frame, so that the hand feels each.
Trace pull(double blend) {
  Scene scene = TearingBoard::scene({18, 18, 1, 50, 50, 2.5});
  scene.fracture.model = FractureModel::a;
  scene.fracture.max_events = 1;
  scene.live = true;
  scene.steps = 1 << 30;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  const auto forces = simulation.grip_forces();
  forces->blend(blend);
  simulation.step();
  Hand hand;
  hand.grip = simulation.grasp(Vec3(50, 0, 1.25), 3, true);
  hand.position = simulation.centre_of(hand.grip);
  simulation.step();
  Trace trace;
  trace.held = static_cast<int>(simulation.held_nodes(hand.grip).size());
  const auto start = InstrumentForces::Clock::now();
  const auto ruptures = [&] {
    return simulation.destroyed().empty() ? 0 : simulation.destroyed().back().event + 1;
  };
  for (int t = 0; ruptures() < kRuptures && t < kMost; ++t) {
    hand.position.y() -= kSpeed;
    if (t % kFrame == 0) {
      simulation.pose(hand.grip, {hand.position});
      simulation.step();
    }
    const Felt felt = forces->feel({}, {}, {&hand, 1}, start + std::chrono::milliseconds(t));
    trace.ticks.push_back({hand.force, ruptures(), felt.share});
  }
  return trace;
}

}  // namespace

int main(int count, char** arguments) {
  const std::array<double, 4> blends{0, 5, 10, 20};
  std::array<Trace, 4> traces;
  for (std::size_t i = 0; i < blends.size(); ++i) traces[i] = pull(blends[i]);
  const Trace& plain = traces[0];
  if (plain.ticks.empty() || plain.ticks.back().ruptures < kRuptures) {
    std::cerr << "the board did not tear " << kRuptures << " times\n";
    return 1;
  }
  std::printf("%d ruptures in %zu ms, %d nodes held, up to %.3f N\n", plain.ticks.back().ruptures,
              plain.ticks.size(), plain.held, plain.strongest());
  std::printf("blend [ms]  largest change in 1 ms [N]: of ruptures  of the hand's motion alone\n");
  for (std::size_t i = 0; i < blends.size(); ++i) {
    const auto most = traces[i].largest();
    std::printf("%10g  %42.4f  %28.4f\n", blends[i], most[0], most[1]);
  }
  if (count < 2) return 0;
  std::ofstream out(arguments[1]);
  out << "ms,ruptures";
  for (double blend : blends) out << ",force_blend_" << blend;
  out << "\n";
  for (std::size_t t = 0; t < plain.ticks.size(); ++t) {
    out << t << "," << plain.ticks[t].ruptures;
    for (const Trace& trace : traces) out << "," << trace.ticks[t].force.norm();
    out << "\n";
  }
  return out ? 0 : 1;
}
