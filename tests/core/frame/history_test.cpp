// SPDX-License-Identifier: Apache-2.0
// Back and forth: whatever is taken back, the same steps again give the same bits.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "core/frame/run_state.hpp"
#include "core/frame/strip.hpp"
#include "sunder/error.hpp"
#include "sunder/scene_keys.hpp"
#include "support/notch_board.hpp"

namespace sunder::test {
namespace {

struct HistoryRun : SceneRun {
  explicit HistoryRun(Scene scene, int quick = 200) : SceneRun(std::move(scene)) {
    simulation.keep_history([p = problem] { return cpu_reference::create(p, needs_of(*p)); },
                            quick);
  }
};

struct World {
  const char* name;
  std::function<Scene()> scene;
  bool quick;  // goes back by the backend's own states
};

Scene by_route(Scene scene, Route route) {
  scene.solver.route = route;
  return scene;
}

Scene with_law(Scene scene, MaterialLaw law) {
  for (auto& [name, material] : scene.materials) material.law = law;
  return scene;
}

Scene with_fibres(Scene scene, MaterialLaw law) {
  scene = with_law(std::move(scene), law);
  for (auto& [name, material] : scene.materials) material.fibres = {slanted_fibres(law)};
  return scene;
}

/// Under a constant load, some events a step.
Scene torn(int events_of_a_step = 3, double yield = 0.6, double force = 3) {
  Scene scene = strip(yield, force, 8);
  scene.instruments[0].ramp.reset();
  scene.fracture.max_events = events_of_a_step;
  return scene;
}

Scene gripped() {
  Scene scene = torn();
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(0, -2, 0), Axes{7}};
  return scene;
}

Scene moving() {
  Scene scene = torn(3, 0.1, 2);
  scene.materials["board"].density = 1e-9;
  scene.dynamics = Dynamics{.time_step = 0.002};
  scene.materials["board"].law = MaterialLaw::corotated;
  return scene;
}

Scene split(bool contact = false) {
  Scene scene = notch_board(FractureModel::b);
  scene.fracture.contact = contact;
  scene.fracture.crack = CrackWay::split;
  scene.fracture.sif = SifSource::field;
  scene.fracture.max_events = 2;
  scene.steps = 8;
  scene.instruments[0].ramp.reset();
  return scene;
}

Scene by_formula(int events_of_a_step = 3) {
  Scene scene = notch_board(FractureModel::b);
  scene.fracture.max_events = events_of_a_step;
  scene.instruments[0].ramp.reset();
  scene.steps = 8;
  return scene;
}

Scene averaged() {
  Scene scene = torn(3, 0.35);
  scene.fracture.averaging = 1.2;
  return scene;
}

/// Its lower half is bonded to the upper one.
Scene bonded() {
  Scene scene = gripped();
  scene.mesh = structured_board({4, 8, 1, 4, 8, 1},
                                [](const Vec3& x) { return x.y() < 4 ? "board" : "other"; });
  scene.materials["board"].yield.reset();
  scene.materials["other"] = scene.materials["board"];
  scene.interfaces.push_back({{"board", "other"}, 0.15, 0.05, 1});
  scene.fracture.max_events = 3;
  scene.steps = 8;
  return scene;
}

const std::vector<World>& worlds() {
  static const std::vector<World> all{
      {"inverse", [] { return by_route(torn(), Route::inverse); }, true},
      {"factor", [] { return by_route(torn(), Route::factor); }, true},
      {"cg", [] { return by_route(torn(), Route::cg); }, true},
      {"condensed", [] { return by_route(torn(), Route::condensed); }, true},
      {"eager",
       [] {
         Scene scene = by_route(torn(), Route::inverse);
         scene.solver.update = Update::eager;
         return scene;
       },
       false},
      {"grip", [] { return gripped(); }, true},
      {"model_b", [] { return by_formula(); }, true},
      {"model_b_factor", [] { return by_route(by_formula(), Route::factor); }, true},
      {"field",
       [] {
         Scene scene = by_formula();
         scene.fracture.sif = SifSource::field;
         return scene;
       },
       true},
      {"averaged", [] { return averaged(); }, true},
      {"split", [] { return split(); }, true},
      {"split_inverse", [] { return by_route(split(), Route::inverse); }, true},
      {"split_factor", [] { return by_route(split(), Route::factor); }, true},
      {"split_contact", [] { return split(true); }, true},
      {"split_corotated", [] { return with_law(split(), MaterialLaw::corotated); }, false},
      {"corotated", [] { return with_law(torn(3, 0.4, 2), MaterialLaw::corotated); }, false},
      {"motion", [] { return moving(); }, false},
      {"fibres", [] { return with_fibres(torn(3, 0.4, 2), MaterialLaw::neo_hookean); }, false},
      {"fibres_linear", [] { return with_fibres(torn(), MaterialLaw::linear); }, false},
      {"interface", [] { return bonded(); }, false},
      {"motion_fibres", [] { return with_fibres(moving(), MaterialLaw::corotated); }, false},
  };
  return all;
}

class Back : public testing::TestWithParam<World> {};

TEST_P(Back, TheSameStepsAgainGiveTheSameBits) {
  HistoryRun run(GetParam().scene());
  Simulation& s = run.simulation;
  std::vector<RunState> states{RunState(s)};
  std::vector<int> events{0};
  while (!s.done()) {
    events.push_back(events.back() + s.step().events);
    states.emplace_back(s);
  }
  ASSERT_GE(s.undos(), 1) << "of steps in which something broke";
  for (int actions : {1, 2, s.undos()}) {
    if (actions > s.undos()) continue;
    const int undos = s.undos();
    const Travel travel = s.undo(actions);
    EXPECT_EQ(travel.replayed, !GetParam().quick);
    const auto at = static_cast<std::size_t>(s.steps_done());
    EXPECT_EQ(travel.events, events.back() - events[at]);
    expect_same_bits(RunState(s), states[at]);
    EXPECT_EQ(s.undos(), undos - actions);
    EXPECT_EQ(s.redos(), actions);
    while (!s.done()) {
      s.step();
      expect_same_bits(RunState(s), states[static_cast<std::size_t>(s.steps_done())]);
    }
    EXPECT_EQ(s.redos(), 0) << "other steps have been taken since";
  }
}

TEST_P(Back, RedoAndMarksComeToTheSameBits) {
  HistoryRun run(GetParam().scene());
  Simulation& s = run.simulation;
  s.step();
  const RunState early(s);
  const Mark mark = s.save();
  while (!s.done() && s.undos() < 2) s.step();
  const RunState before(s);
  const Mark late = s.save();
  s.undo();
  s.redo();
  expect_same_bits(RunState(s), before);
  s.restore(mark);
  expect_same_bits(RunState(s), early);
  s.restore(late);  // forward again, past what was done before
  expect_same_bits(RunState(s), before);
  const Mark again = s.save();
  s.restore(mark);
  if (s.problem().scene().instruments.size() == 1) s.drive(0, Vec3(0, -0.1, 0));
  s.step();
  const RunState other(s);
  const Mark branch = s.save();
  s.restore(again);
  expect_same_bits(RunState(s), before);
  s.restore(branch);
  expect_same_bits(RunState(s), other);
}

TEST_P(Back, ANewBackendGoesOnWithTheSameBits) {
  HistoryRun run(GetParam().scene());
  Simulation& s = run.simulation;
  const RunState start(s);
  s.renew_backend();
  expect_same_bits(RunState(s), start);
  while (!s.done() && s.undos() < 2) s.step();
  const RunState late(s);
  s.undo();
  const RunState early(s);
  const Backend* const before = &s.backend();
  const int undos = s.undos();
  s.renew_backend();
  EXPECT_NE(&s.backend(), before);
  expect_same_bits(RunState(s), early);
  EXPECT_EQ(s.undos(), undos);
  EXPECT_EQ(s.redos(), 1) << "what was taken back can still be done again";
  s.redo();
  expect_same_bits(RunState(s), late);
}

INSTANTIATE_TEST_SUITE_P(Worlds, Back, testing::ValuesIn(worlds()),
                         [](const auto& of) { return std::string(of.param.name); });

/// Single elements far from one another, taken out one by one, with a step after each.
Scene large(Route route) {
  Scene scene = strip(1e9, 1, 1000);
  scene.mesh = structured_board({12, 24, 1, 12, 24, 1});
  scene.supports[0].nodes = band(23.9, 25);
  scene.instruments[0].ramp.reset();
  scene.solver.route = route;
  scene.live = true;
  return scene;
}

class ManyEvents : public testing::TestWithParam<Route> {};

// By routes inverse and factor other bases come on the way; states hold those that they rest on.
TEST_P(ManyEvents, OneTenAndAHundredAreTakenBack) {
  HistoryRun run(large(GetParam()));
  Simulation& s = run.simulation;
  std::vector<Index> order(12 * 24);
  for (std::size_t c = 0; c < order.size(); ++c) order[c] = static_cast<Index>(6 * c + c % 6);
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  std::vector<RunState> states{RunState(s)};
  const auto go_on = [&](std::size_t to) {
    for (std::size_t i = static_cast<std::size_t>(s.undos()); i < to; ++i) {
      s.remove(std::vector<Index>{order[i]});
      s.step();
      if (states.size() == i + 1) states.emplace_back(s);
    }
  };
  go_on(120);
  for (const int events : {1, 10, 100}) {
    const Travel travel = s.undo(events);
    EXPECT_EQ(travel.events, events);
    EXPECT_FALSE(travel.replayed);
    expect_same_bits(RunState(s), states[static_cast<std::size_t>(120 - events)]);
    go_on(120);
    expect_same_bits(RunState(s), states[120]);
  }
}

INSTANTIATE_TEST_SUITE_P(Routes, ManyEvents,
                         testing::Values(Route::inverse, Route::condensed, Route::factor,
                                         Route::cg),
                         [](const auto& of) {
                           return key_words("solver", "route")[static_cast<std::size_t>(of.param)];
                         });

// Observers and the clock end steps; what is done again ends them where they did.
TEST(History, StepsThatWereEndedEarlyEndThereAgain) {
  for (const bool by_time : {false, true}) {
    Scene scene = strip(0.35, 2, 5);
    scene.instruments[0].ramp.reset();
    HistoryRun run(scene, 0);  // no quick states: all is done again
    int heard = 0;
    run.simulation.observe_events([&](auto) { return by_time || ++heard % 2 == 0; });
    Simulation& s = run.simulation;
    const auto step = [&] { by_time ? s.step_within(1e-6) : s.step(); };
    step();
    step();
    const RunState two(s);
    step();
    const int before = heard;
    const Travel travel = s.undo();
    EXPECT_TRUE(travel.replayed);
    EXPECT_EQ(heard, before) << "nobody is told of what is done again";
    expect_same_bits(RunState(s), two);
    s.redo();
    EXPECT_EQ(s.steps_done(), 3);
  }
}

TEST(History, DrivesAndTurnsGoBackToo) {
  HistoryRun run(gripped());
  Simulation& s = run.simulation;
  s.drive(0, Vec3(0, -0.2, 0));
  s.step();
  const RunState gentle(s);
  s.drive(0, Vec3(0, -2, 0));
  s.step();
  ASSERT_EQ(s.undos(), 1);
  s.undo();
  expect_same_bits(RunState(s), gentle);
  s.step();  // driven as it was before the step that was taken back
  EXPECT_EQ(s.undos(), 1);
}

TEST(History, ForcesOfGripsAreThoseOfTheStateThatItIsIn) {
  for (const int quick : {0, 10}) {
    HistoryRun run(gripped(), quick);
    Simulation& s = run.simulation;
    const auto forces = s.backend().instrument_forces();
    ASSERT_TRUE(forces);
    std::vector<double> d(static_cast<std::size_t>(forces->size()), 0.1), before(d), after(d);
    s.drive(0, Vec3(0, -0.2, 0));
    s.step();
    ASSERT_EQ(s.undos(), 0) << "gentle";
    ASSERT_TRUE(forces->forces(d, before));
    s.drive(0, Vec3(0, -2, 0));
    s.step();
    ASSERT_EQ(s.undos(), 1);
    ASSERT_TRUE(forces->forces(d, after));
    EXPECT_NE(before, after);
    s.undo();
    ASSERT_TRUE(forces->forces(d, after));
    EXPECT_EQ(before, after) << quick;
  }
}

TEST(History, RefusesInOneSentence) {
  const auto refused = [](const std::function<void()>& call, const std::string& why) {
    try {
      call();
      ADD_FAILURE() << why;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  SceneRun none(strip(0.6, 3, 6));
  refused([&] { static_cast<void>(none.simulation.save()); }, "keeps no history");
  refused([&] { none.simulation.undo(); }, "keeps no history");
  refused([&] { none.simulation.renew_backend(); }, "keeps no history");
  none.simulation.step();
  refused([&] { none.simulation.keep_history(); }, "before the first step");

  HistoryRun run(strip(0.6, 3, 6)), other(strip(0.6, 3, 6));
  refused([&] { run.simulation.keep_history(); }, "already");
  refused([&] { run.simulation.undo(); }, "there are 0 actions to take back");
  refused([&] { run.simulation.redo(); }, "there are 0 actions to do again");
  refused([&] { run.simulation.restore(other.simulation.save()); }, "another simulation");
  refused([&] { run.simulation.restore({}); }, "another simulation");

  // Without a way to make a backend the quick way is the only one.
  SceneRun alone(with_law(torn(3, 0.4, 2), MaterialLaw::corotated));
  alone.simulation.keep_history();
  while (alone.simulation.undos() == 0) alone.simulation.step();
  const RunState state(alone.simulation);
  refused([&] { alone.simulation.undo(); }, "needs a new backend");
  refused([&] { alone.simulation.renew_backend(); }, "needs a new backend");
  expect_same_bits(RunState(alone.simulation), state);
}

}  // namespace
}  // namespace sunder::test
