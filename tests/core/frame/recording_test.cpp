// SPDX-License-Identifier: Apache-2.0
// A history as bytes, told to another simulation of the same body; blades.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "core/frame/run_state.hpp"
#include "core/frame/strip.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

Scene gripped_to_break(double yield = 0.6) {
  Scene scene = strip(yield, 3, 12);
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(0, -2, 0), Axes{7}, true};
  return scene;
}

struct Recorded : SceneRun {
  explicit Recorded(Scene scene) : SceneRun(std::move(scene)) {
    simulation.keep_history([p = problem] { return cpu_reference::create(p, needs_of(*p)); });
  }
};

/// Something of everything.
void play(Simulation& s) {
  s.attribute_events(true);
  s.step();
  s.drive(0, Vec3(0, -0.6, 0.1));
  s.turn(0, Vec3(0, 0, 4));
  s.step();
  s.remove(std::vector<Index>{70, 71, 75});
  s.step_within(1e-6);
  s.drive(0, Vec3(0, -1.8, 0));
  s.step();
}

TEST(Recording, ToldToAnotherGivesTheSameBits) {
  Recorded first(gripped_to_break()), second(gripped_to_break());
  play(first.simulation);
  ASSERT_GT(first.simulation.destroyed().size(), 4U) << "beyond what was removed";
  const auto bytes = first.simulation.store();
  second.simulation.load(bytes);
  expect_same_bits(RunState(first.simulation), RunState(second.simulation));
  EXPECT_EQ(second.simulation.store(), bytes);
  EXPECT_EQ(second.simulation.undos(), first.simulation.undos());
  second.simulation.undo();
  first.simulation.undo();
  expect_same_bits(RunState(first.simulation), RunState(second.simulation));
  // Wherever it is: from the beginning.
  second.simulation.load(bytes);
  first.simulation.redo();
  expect_same_bits(RunState(first.simulation), RunState(second.simulation));
}

TEST(Recording, IsPlayedStepByStepBeforeObservers) {
  Recorded first(gripped_to_break());
  play(first.simulation);
  const auto bytes = first.simulation.store();
  Scene scene = gripped_to_break();
  scene.live = true;  // plays what one that is not live has recorded
  SceneRun second(scene);
  Simulation& s = second.simulation;
  s.open_recording(bytes);
  std::size_t seen = 0;
  int frames = 0, steps = 0;
  s.observe_events([&](const auto& event) {
    seen += event.size();
    return true;
  });
  s.observe_frames([&] { ++frames; });
  while (s.reach_recorded_step()) {
    EXPECT_EQ(s.recorded_step().step, steps++);
    EXPECT_FALSE(s.interrupted());
  }
  EXPECT_EQ(steps, 4);
  EXPECT_GE(frames, steps);
  EXPECT_EQ(seen + 3, s.destroyed().size()) << "all but what was removed";
  expect_same_bits(RunState(first.simulation), RunState(s));
  EXPECT_THROW(s.recorded_step(), UsageError);
  EXPECT_THROW(s.open_recording(bytes), UsageError);
  SceneRun other(gripped_to_break(0.7));
  EXPECT_THROW(other.simulation.open_recording(bytes), InputError);
}

TEST(Recording, StandsForTheSameWithAnotherNumberOfThreadsAndAnotherClock) {
  // The scene's own bound on time does not decide again where a step ends.
  Scene scene = strip(0.35, 2, 3);
  scene.instruments[0].ramp.reset();
  scene.solver.max_ms = 1e-6;
  Recorded slow(scene);
  slow.simulation.step();
  slow.simulation.step();
  scene.solver.max_ms = 0;
  Recorded quick(scene);
  quick.simulation.load(slow.simulation.store());
  EXPECT_EQ(quick.simulation.destroyed().size(), 2U);
  EXPECT_TRUE(quick.simulation.displacement() == slow.simulation.displacement());
}

/// What a hand may do, by chance.
class Hand {
 public:
  explicit Hand(unsigned seed) : random_(seed) {}
  void act(Simulation& s) {
    const unsigned what = below(20);
    if (what < 9) s.step();
    if (what == 9) s.step_within(1e-6);
    if (what == 10 || what == 11) s.drive(0, Vec3(part(), -2 * part(), part()));
    if (what == 12) s.turn(0, 3 * Vec3(part(), part(), part()));
    if (what == 13 || what == 18) remove(s);
    if (what == 14 && s.undos() > 0) s.undo();
    if (what == 15 && s.redos() > 0) s.redo();
    if (what == 16 || marks_.empty()) marks_.push_back(s.save());
    if (what != 17) return;
    const std::size_t late = std::min<std::size_t>(marks_.size(), 4);  // of the last few
    s.restore(marks_[marks_.size() - 1 - below(static_cast<unsigned>(late))]);
  }

 private:
  unsigned below(unsigned n) { return static_cast<unsigned>(random_()) % n; }
  double part() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  void remove(Simulation& s) {
    const auto e = static_cast<Index>(below(static_cast<unsigned>(s.problem().tet_count())));
    if (!s.backend().destroyed()[e]) s.remove(std::vector<Index>{e});
  }
  std::mt19937 random_;
  std::vector<Mark> marks_;
};

TEST(Recording, OfRandomActionsLeadsToWhereTheyLed) {
  for (const Route route : {Route::inverse, Route::condensed, Route::factor, Route::cg}) {
    SCOPED_TRACE(static_cast<int>(route));
    Scene scene = gripped_to_break(0.5);
    scene.steps = 1 << 30;
    scene.solver.route = route;
    scene.fracture.max_events = 2;
    Recorded run(scene);
    Hand hand(41 + static_cast<unsigned>(route));
    int broke = 0;  // actions that took something
    for (int i = 0; i < 400; ++i) {
      const std::size_t before = run.simulation.destroyed().size();
      try {
        hand.act(run.simulation);
      } catch (const NumericalError&) {  // a piece that grips alone hold, torn off
      }
      broke += run.simulation.destroyed().size() > before ? 1 : 0;
      if (i % 50 != 49) continue;
      Recorded fresh(scene);
      fresh.simulation.load(run.simulation.store());
      expect_same_bits(RunState(fresh.simulation), RunState(run.simulation));
    }
    EXPECT_GT(broke, 9);
  }
}

void refused(Simulation& simulation, std::vector<std::uint8_t> bytes, const std::string& why) {
  const RunState before(simulation);
  try {
    simulation.load(bytes);
    ADD_FAILURE() << why;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
  }
  expect_same_bits(RunState(simulation), before);
}

TEST(Recording, RefusesDamageOtherVersionsAndOtherBodies) {
  Recorded run(gripped_to_break());
  play(run.simulation);
  const auto bytes = run.simulation.store();
  Simulation& s = run.simulation;
  refused(s, {}, "no recording");
  refused(s, {'P', 'K', 3, 4, 0, 0, 0, 0, 0}, "no recording");
  const std::size_t whole = bytes.size();
  for (const std::size_t length :
       {std::size_t{8}, std::size_t{12}, std::size_t{20}, whole / 2, whole - 1}) {
    refused(s, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)}, "damaged");
  }
  for (std::size_t at = 12; at < bytes.size(); ++at) {
    auto changed = bytes;
    changed[at] ^= 0x10;
    refused(s, changed, "damaged");
  }
  auto later = bytes;
  later[8] = 5;
  refused(s, later, "version 5; this library reads versions 1 to 4");
  Recorded stronger(gripped_to_break(0.7));
  refused(stronger.simulation, bytes, "another body");
  Scene other = gripped_to_break();
  other.solver.route = Route::cg;
  Recorded by_cg(std::move(other));
  refused(by_cg.simulation, bytes, "another body");
  SceneRun none(gripped_to_break());
  EXPECT_THROW(static_cast<void>(none.simulation.store()), UsageError);
  EXPECT_THROW(none.simulation.load(bytes), UsageError);
}

/// The plane y = 4.5 between two places of a blade.
std::vector<std::array<Vec3, 3>> blade(double from, double to, double y = 4.5) {
  const Vec3 a(from, y, -1), b(from, y, 2), c(to, y, -1), d(to, y, 2);
  return {{a, b, c}, {b, d, c}};
}

Scene uncut() {
  Scene scene = strip(1e9, 2, 4);
  scene.live = true;
  return scene;
}

TEST(Cut, TakesWhatTheBladePasses) {
  SceneRun run(uncut());
  // Half of the width, through the middle of the fifth row of cells: its left two cells, whole.
  EXPECT_EQ(run.simulation.cut(blade(-1, 2)), 12);
  for (Index e = 0; e < run.problem->tet_count(); ++e) {
    const Index cell = e / 6;
    EXPECT_EQ(run.simulation.backend().destroyed()[e] != 0, cell == 16 || cell == 17) << e;
  }
  EXPECT_EQ(run.simulation.destroyed().front().cause, Cause::script);
  EXPECT_EQ(run.simulation.destroyed().back().event, 0) << "one event";
  EXPECT_EQ(run.simulation.cut(blade(-1, 2)), 0) << "nothing is left there";
  EXPECT_EQ(run.simulation.cut(blade(7, 9)), 0) << "beside the body";
  EXPECT_EQ(run.simulation.cut({}), 0);
}

TEST(Cut, SeesTheBodyAsItIs) {
  SceneRun run(uncut());
  run.simulation.step();
  run.simulation.step();
  const auto u = run.simulation.displacement();
  double lowest = 0;  // of the lower end, which has moved down
  for (const Vec3& v : u) lowest = std::min(lowest, v.y());
  ASSERT_LT(lowest, -0.2);
  EXPECT_GT(run.simulation.cut(blade(-1, 5, -0.15)), 0) << "it was not there undeformed";
}

TEST(Cut, RefusesWhatHasNoPlace) {
  SceneRun run(uncut());
  EXPECT_THROW(run.simulation.cut(blade(NAN, 2)), UsageError);
}

TEST(Cut, OpensFacesWhereCracksSplit) {
  Scene split = notched(FractureModel::b);
  split.fracture.crack = CrackWay::split;
  split.fracture.sif = SifSource::field;
  SceneRun parted(std::move(split));
  EXPECT_GT(parted.simulation.cut(blade(-1, 2)), 0);
  const auto gone = std::ranges::count(parted.simulation.backend().destroyed(), 1);
  EXPECT_EQ(gone, 6);  // the notch
}

}  // namespace
}  // namespace sunder::test
