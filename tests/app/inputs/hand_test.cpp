// SPDX-License-Identifier: Apache-2.0
// The record of what was done: done again on a fresh simulation it leads to the same bits, whatever
// was taken back on the way.
#include "app/inputs/hand.hpp"

#include <gtest/gtest.h>

#include "core/frame/run_state.hpp"
#include "core/frame/strip.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using namespace app;

Scene torn(MaterialLaw law = MaterialLaw::linear) {
  Scene scene = strip(0.6, 3, 12);
  scene.live = true;
  scene.fracture.max_events = 2;
  scene.instruments[0].ramp.reset();
  for (auto& [name, material] : scene.materials) material.law = law;
  return scene;
}

std::unique_ptr<Backend> backend_of(const std::shared_ptr<const Problem>& problem) {
  return create_backend(problem, needs_of(*problem)).backend;
}

struct Handled {
  explicit Handled(Scene scene)
      : problem(std::make_shared<const Problem>(std::move(scene))),
        simulation(problem, backend_of(problem)) {
    simulation.keep_history([p = problem] { return backend_of(p); });
    hand.emplace(simulation, true);
  }
  std::shared_ptr<const Problem> problem;
  Simulation simulation;
  std::optional<app::Hand> hand;
};

/// The recording done again, as a run does it.
void expect_same_bits_again(Handled& done) {
  Inputs inputs = parse_inputs(done.hand->recording(), "recording");
  resolve(inputs, *done.problem);
  Simulation again(done.problem, backend_of(done.problem));
  app::Hand hand(again, false);
  Replay replay(inputs, hand, done.problem->scene().steps);
  while (replay.reach_step()) again.step();
  expect_same_bits(RunState(again), RunState(done.simulation));
}

input::Drive drive(const Vec3& value, bool further = false) {
  return {"forceps", value, further, 0};
}

void pull_cut_and_go_back(Handled& run) {
  app::Hand& hand = *run.hand;
  hand.step();
  hand.drive(drive({3.3, 0.1, 0}));
  hand.step();
  hand.undo(1);
  hand.drive(drive({0.2, 0, 0}, true));
  hand.step();
  const std::vector<Index> some{40, 41};
  hand.remove(some);
  hand.undo(1);
  hand.redo(1);
  hand.step();
}

TEST(Hand, RecordsWhatLedThereByTheLinearLaw) {
  Handled run(torn());
  pull_cut_and_go_back(run);
  ASSERT_GT(run.simulation.destroyed().size(), 2U);
  expect_same_bits_again(run);
}

TEST(Hand, RecordsWhatLedThereByALawOfFiniteDeformation) {
  Handled run(torn(MaterialLaw::corotated));
  pull_cut_and_go_back(run);
  expect_same_bits_again(run);
}

/// Upright, from above into a third of the body.
input::Cut blade_into(const Problem& problem) {
  Vec3 low = problem.mesh().nodes.front(), high = low;
  for (const Vec3& x : problem.mesh().nodes) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double x = (low.x() + high.x()) / 2 + 0.01, y = high.y() - (high.y() - low.y()) / 3;
  return {{{x, high.y() + 1, low.z() - 1},
           {x, high.y() + 1, high.z() + 1},
           {x, y, low.z() - 1},
           {x, y, high.z() + 1}}};
}

TEST(Hand, RecordsACutAsTheElementsThatItTook) {
  Handled run(torn());
  run.hand->step();
  const input::Cut blade = blade_into(*run.problem);
  const std::size_t before = run.simulation.destroyed().size();
  const int cut = run.hand->cut(blade);
  EXPECT_GT(cut, 0);
  EXPECT_EQ(run.simulation.destroyed().size(), before + static_cast<std::size_t>(cut));
  EXPECT_NE(run.hand->recording().find("remove "), std::string::npos);
  run.hand->step();
  expect_same_bits_again(run);
}

/// Where cracks split, faces open: the blade itself is the record.
TEST(Hand, RecordsABladeThatOpensFaces) {
  Scene scene = torn();
  scene.fracture.model = FractureModel::b;
  scene.fracture.crack = CrackWay::split;
  scene.fracture.sif = SifSource::field;
  Handled run(std::move(scene));
  run.hand->step();
  const input::Cut blade = blade_into(*run.problem);
  const std::size_t before = run.simulation.cracks().size();
  EXPECT_GT(run.hand->cut(blade), 0);
  EXPECT_EQ(run.simulation.cracks().size(), before + 1);
  EXPECT_NE(run.hand->recording().find("cut "), std::string::npos);
  run.hand->step();
  run.hand->undo(1);
  run.hand->redo(1);
  const input::Cut beside{{{900, 0, 0}, {900, 0, 1}, {901, 0, 0}, {901, 0, 1}}};
  EXPECT_EQ(run.hand->cut(beside), 0);
  expect_same_bits_again(run);
}

TEST(Hand, ForgetsWhatWasUndoneAndAllAtAReset) {
  Handled run(torn());
  app::Hand& hand = *run.hand;
  hand.step();
  const std::string first = hand.recording();
  EXPECT_EQ(first, "step\n");
  const std::vector<Index> some{40};
  hand.remove(some);
  EXPECT_EQ(hand.recording(), "step\nremove 40\n");
  hand.undo(1);
  EXPECT_EQ(hand.recording(), first);
  hand.redo(1);
  EXPECT_EQ(hand.recording(), "step\nremove 40\n");
  hand.reset();
  EXPECT_EQ(hand.recording(), "");
  EXPECT_EQ(run.simulation.steps_done(), 0);
  EXPECT_TRUE(run.simulation.destroyed().empty());
  EXPECT_THROW(hand.undo(1), UsageError);
}

TEST(Hand, MovesAnInstrumentFromWhereItIs) {
  Scene scene = torn();
  const Vec3 force = std::get<Pull>(scene.instruments[0].action).force;
  scene.instruments[0].ramp = Ramp{0, 1};
  Handled run(std::move(scene));
  EXPECT_EQ(run.hand->value(0), Vec3(0, 0, 0));
  run.hand->step();
  EXPECT_EQ(run.hand->value(0), Vec3(force / 12));
  run.hand->drive(drive({1, 2, 3}, true));
  EXPECT_EQ(run.hand->value(0), Vec3(force / 12 + Vec3(1, 2, 3)));
}

TEST(Replay, RefusesWhatGoesBackOrLooks) {
  Handled run(torn());
  for (const char* text :
       {"undo", "redo", "reset", "pause", "go", "stroke 0 0 1 1", "set a=1", "open a.toml"}) {
    SCOPED_TRACE(text);
    const Inputs inputs = parse_inputs(text, "in.txt");
    try {
      const Replay replay(inputs, *run.hand, 12);
      ADD_FAILURE() << "was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("in.txt:1: "), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("is for sunder view"), std::string::npos);
    }
  }
  const Inputs many = parse_inputs("step 12\nstep", "in.txt");
  EXPECT_THROW(Replay(many, *run.hand, 12), InputError);
}

TEST(Replay, NamesTheLineOfAnInputThatTheBodyRefuses) {
  Handled run(torn());
  Inputs inputs = parse_inputs("remove 40\nremove 40\nstep", "in.txt");
  resolve(inputs, *run.problem);
  Replay replay(inputs, *run.hand, 12);
  try {
    static_cast<void>(replay.reach_step());
    ADD_FAILURE() << "was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("in.txt:2: element 40"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace sunder::test
