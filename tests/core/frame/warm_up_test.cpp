// SPDX-License-Identifier: Apache-2.0
// A warm-up: the first step takes no more work than the second, whichever way the instruments go;
// nothing of it is seen; what was recorded with it has the same bits again.
#include <gtest/gtest.h>

#include <cmath>

#include "core/frame/run_state.hpp"
#include "core/frame/strip.hpp"

namespace sunder::test {
namespace {

constexpr Route kChecked[] = {Route::inverse, Route::factor, Route::condensed};

/// A pull at one side of the lower end, and a grip that shifts and turns at the other.
Scene two_hands(double yield, Route route) {
  Scene scene = strip(yield, 2, 6);
  scene.instruments[0].action = Pull{Box{Vec3(-1, -1, -1), Vec3(1.1, 0.1, 9)}, Vec3(0, -2, 0)};
  Instrument grip;
  grip.name = "grip";
  grip.action =
      Grip{Box{Vec3(2.9, -1, -1), Vec3(9, 0.1, 9)}, Vec3(0, -0.1, 0), Axes{7}, true, Vec3(0, 0, 2)};
  grip.ramp = Ramp{0, 1};
  scene.instruments.push_back(grip);
  scene.solver.route = route;
  return scene;
}

void wander(Simulation& s, int step) {
  const double at = 1 + 2.3 * step;
  s.drive(0, Vec3(std::sin(at), -1 - std::cos(1.7 * at), 0.3 * std::cos(at)));
  s.drive(1, Vec3(0.01 * std::cos(3 * at), -0.02, 0.01 * std::sin(at)));
  s.turn(1, Vec3(std::sin(2 * at), std::cos(at), 1.5));
}

int back_solves_of_step(SceneRun& run, int step, bool driven) {
  if (driven) wander(run.simulation, step);
  const StepReport report = run.simulation.step();
  EXPECT_EQ(report.destroyed, 0);
  return report.back_solves;
}

class WarmUp : public testing::TestWithParam<Route> {};

// A cold one shows that the count can tell: its first step checks its solution fully, and so does
// the next one that goes another way.
TEST_P(WarmUp, TheFirstStepCostsWhatTheSecondDoes) {
  for (const bool driven : {false, true}) {
    SceneRun cold(two_hands(1e9, GetParam())), warm(two_hands(1e9, GetParam()));
    EXPECT_GT(back_solves_of_step(cold, 0, driven), 1);
    warm.simulation.warm_up();
    const int first = back_solves_of_step(warm, 0, driven);
    EXPECT_EQ(first, 1) << driven;
    for (int step = 1; step < 5; ++step) {
      EXPECT_EQ(back_solves_of_step(warm, step, driven), first) << step;
    }
  }
}

TEST_P(WarmUp, IsNotSeenAndKeepsTheAccuracy) {
  SceneRun cold(two_hands(0.5, GetParam())), warm(two_hands(0.5, GetParam()));
  warm.simulation.warm_up();
  EXPECT_EQ(warm.simulation.steps_done(), 0);
  for (const Vec3& u : warm.simulation.displacement()) EXPECT_EQ(u, Vec3::Zero());
  for (const Vec3& f : warm.simulation.reactions()) EXPECT_EQ(f, Vec3::Zero());
  cold.all();
  warm.all();
  warm.simulation.warm_up();  // too late: nothing
  ASSERT_GT(cold.simulation.destroyed().size(), 0u);
  ASSERT_EQ(cold.simulation.destroyed().size(), warm.simulation.destroyed().size());
  for (std::size_t i = 0; i < cold.simulation.destroyed().size(); ++i) {
    EXPECT_EQ(cold.simulation.destroyed()[i].element, warm.simulation.destroyed()[i].element);
  }
  const auto u = cold.simulation.displacement(), v = warm.simulation.displacement();
  double largest = 0, off = 0;
  for (std::size_t n = 0; n < u.size(); ++n) {
    largest = std::max(largest, u[n].norm());
    off = std::max(off, (u[n] - v[n]).norm());
  }
  EXPECT_LE(off, 1e-8 * largest);  // what a deferred update promises
}

TEST_P(WarmUp, IsRecordedAndDoneAgainWithTheSameBits) {
  const auto make = [](const SceneRun& run) {
    return [p = run.problem] { return cpu_reference::create(p, needs_of(*p)); };
  };
  SceneRun first(two_hands(0.5, GetParam())), second(two_hands(0.5, GetParam()));
  // Also a warm-up before the history begins, and drives on both sides of it.
  wander(first.simulation, 0);
  first.simulation.warm_up();
  first.simulation.keep_history(make(first));
  const Mark start = first.simulation.save();
  for (int step = 0; step < 3; ++step) {
    wander(first.simulation, step);
    first.simulation.step();
  }
  const auto bytes = first.simulation.store();
  second.simulation.keep_history(make(second), 0);
  second.simulation.load(bytes);
  expect_same_bits(RunState(first.simulation), RunState(second.simulation));
  EXPECT_EQ(second.simulation.store(), bytes);
  const RunState there(first.simulation);
  const Mark end = first.simulation.save();
  first.simulation.restore(start);
  EXPECT_EQ(first.simulation.steps_done(), 0);
  first.simulation.restore(end);
  expect_same_bits(there, RunState(first.simulation));
}

INSTANTIATE_TEST_SUITE_P(Routes, WarmUp, testing::ValuesIn(kChecked),
                         [](const auto& info) -> std::string {
                           return info.param == Route::inverse  ? "inverse"
                                  : info.param == Route::factor ? "factor"
                                                                : "condensed";
                         });

// Route cg checks every solution, finite laws go on from where they are: no bit changes there.
TEST(WarmUpElsewhere, ChangesNoBitWhereNothingIsKept) {
  for (const bool finite : {false, true}) {
    Scene scene = two_hands(0.5, finite ? Route::factor : Route::cg);
    if (finite) scene.materials["board"].law = MaterialLaw::corotated;
    scene.steps = 2;
    SceneRun cold(scene), warm(scene);
    warm.simulation.warm_up();
    cold.all();
    warm.all();
    EXPECT_TRUE(cold.simulation.displacement() == warm.simulation.displacement()) << finite;
  }
}

/// As an older library wrote it.
std::vector<std::uint8_t> of_version(std::vector<std::uint8_t> bytes, std::uint8_t version) {
  bytes[8] = version;
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (std::size_t i = 0; i + 8 < bytes.size(); ++i) hash = (hash ^ bytes[i]) * 0x100000001b3ULL;
  for (std::size_t i = 0; i < 8; ++i) {
    bytes[bytes.size() - 8 + i] = static_cast<std::uint8_t>(hash >> 8 * i & 0xff);
  }
  return bytes;
}

TEST(Recording, OfOlderVersionsAreRead) {
  SceneRun first(strip(0.6, 3, 3));
  first.simulation.keep_history();
  first.simulation.step();
  first.simulation.step();
  for (const std::uint8_t version : {1, 2, 3, 4}) {
    SceneRun again(strip(0.6, 3, 3));
    again.simulation.keep_history({}, 0);
    again.simulation.load(of_version(first.simulation.store(), version));
    expect_same_bits(RunState(first.simulation), RunState(again.simulation));
  }
}

}  // namespace
}  // namespace sunder::test
