// SPDX-License-Identifier: Apache-2.0
// A body whose law, crack way or material is changed while it is looked at, and files opened in its
// place: what was done so far goes along, what cannot be leaves all as it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <thread>

#include "app/input/scene_toml.hpp"
#include "app/output/program.hpp"
#include "app/view/live_session.hpp"
#include "app/view/scene_edit.hpp"
#include "core/frame/run_state.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using namespace app;
using namespace std::chrono_literals;

struct Looked {
  Looked() {
    const BodyPlan first = plan({board.scene, {}});
    session.emplace(first.problem, first.make, true, PictureSize{});
    session->can_change({board.scene, {}}, [this](const Origin& origin) { return plan(origin); });
  }
  [[nodiscard]] BodyPlan plan(const Origin& origin) const {
    const auto problem = read_problem(origin.file, changed({"solver.route=factor"}, origin.changes),
                                      nullptr, nullptr, true);
    return {problem,
            [problem, prepared = prepared] {
              return create_prepared_backend(problem, needs_of(*problem), prepared).backend;
            },
            {}};
  }
  void take(const std::string& line) {
    Inputs inputs = parse_inputs(line, "in");
    resolve(inputs, session->problem());
    for (const Input& input : inputs.list) session->take(inputs, input);
  }
  /// The recording of the body that is there, on a fresh one of its scene.
  void expect_same_bits_again() {
    const BodyPlan fresh = plan(session->origin());
    Inputs inputs = parse_inputs(session->hand().recording(), "recording");
    resolve(inputs, *fresh.problem);
    Simulation again(fresh.problem, fresh.make());
    app::Hand hand(again, false);
    Replay replay(inputs, hand, fresh.problem->scene().steps);
    while (replay.reach_step()) again.step();
    expect_same_bits(RunState(again), RunState(session->simulation()));
  }

  TempFolder folder;
  TearingBoard board{folder};
  std::shared_ptr<cpu_reference::PreparedBodies> prepared = prepared_bodies(2);
  std::optional<Session> session;
};

int gone(const Session& session) {
  return static_cast<int>(session.simulation().destroyed().size());
}

TEST(ChangedBody, ALowerYieldStressTearsAtOnceByTheBaseThatWasThere) {
  Looked looked;
  looked.take("step");
  ASSERT_EQ(gone(*looked.session), 0);
  const auto before = looked.session->simulation().displacement();
  looked.take("set material.upper.yield=9 material.lower.yield=9");
  EXPECT_NE(looked.session->said().find("by the base that was there"), std::string::npos)
      << looked.session->said();
  EXPECT_EQ(looked.session->simulation().displacement(), before) << "by a bit";
  looked.take("set material.lower.yield=0.3");
  EXPECT_GT(gone(*looked.session), 0) << "no step of the caller's was needed";
  EXPECT_EQ(looked.session->origin().changes,
            (std::vector<std::string>{"material.upper.yield=9", "material.lower.yield=0.3"}));
  looked.expect_same_bits_again();
}

TEST(ChangedBody, AnotherModulusTakesANewBaseAndWhatWasDoneAlong) {
  Looked looked;
  looked.take("set material.upper.yield=900 material.lower.yield=900");  // nothing tears
  looked.take("step\nremove 100 101\ngrasp nodes 60\ngrasp 50 25 1.25 6 rigid\n");
  looked.take("pose 1 20 55 1\npose 2 53 24 1.25 0 0 .1 1\ndrive 0 0 -3 0\nstep");
  const auto& before = looked.session->simulation();
  const auto places = looked.session->show(0)->places;
  const std::vector<std::size_t> held{before.held_nodes(1).begin(), before.held_nodes(1).end()};
  const std::vector<std::size_t> patch{before.held_nodes(2).begin(), before.held_nodes(2).end()};
  looked.take("set material.upper.young=50");
  EXPECT_NE(looked.session->said().find("by a new base"), std::string::npos);
  // Two more are those that the scene takes out in its step 1.
  EXPECT_NE(looked.session->said().find("4 elements stay gone, 2 grips hold on"), std::string::npos)
      << looked.session->said();
  EXPECT_EQ(looked.session->hand().value(0), Vec3(0, -3, 0));
  const auto shown = looked.session->show(0);
  EXPECT_EQ(shown->problem->material(0).young,
            looked.plan(looked.session->origin()).problem->material(0).young);
  for (const Index e : {100, 101})
    EXPECT_EQ(shown->state.destroyed[static_cast<std::size_t>(e)], 1);
  for (const auto n : held) EXPECT_LT((shown->places[n] - places[n]).norm(), 1e-9);
  // A patch has its shape at rest again, about the same middle.
  Vec3 middle = Vec3::Zero();
  for (const auto n : patch) middle += shown->places[n] - places[n];
  EXPECT_LT(middle.norm() / static_cast<double>(patch.size()), 1e-9);
  looked.take("step");
  looked.expect_same_bits_again();
  looked.take("reset");
  EXPECT_EQ(gone(*looked.session), 0) << "the changed body, whole";
}

TEST(ChangedBody, LawsAndCrackWaysChangeToAndFro) {
  Looked looked;
  looked.take("step\nremove 100\ngrasp nodes 60\npose 1 20 51 1\nstep");
  looked.take("set material.upper.law=corotated material.lower.law=corotated");
  EXPECT_TRUE(looked.session->problem().finite());
  looked.take("step");
  looked.expect_same_bits_again();
  looked.take("set material.upper.law=linear material.lower.law=linear");
  looked.take("set fracture.crack=split fracture.sif=field");
  EXPECT_EQ(looked.session->problem().scene().fracture.crack, CrackWay::split);
  EXPECT_EQ(looked.session->show(0)->state.destroyed[100], 1);
  looked.take("cut -1 30 -1 -1 30 5 18 30 -1 18 30 5\nstep");
  ASSERT_FALSE(looked.session->simulation().crack_faces().empty());
  looked.expect_same_bits_again();
  looked.take("set fracture.crack=destroyed");
  EXPECT_NE(looked.session->said().find("split crack"), std::string::npos)
      << looked.session->said();
  looked.take("step");
  looked.expect_same_bits_again();
}

TEST(ChangedBody, WhatIsRefusedLeavesEverythingAsItIs) {
  Looked looked;
  looked.take("step\nremove 100");
  const auto* body = &looked.session->simulation();
  const RunState before(looked.session->simulation());
  const auto expect_refused = [&](const std::string& line, const std::string& part) {
    SCOPED_TRACE(line);
    try {
      looked.take(line);
      ADD_FAILURE() << "was taken";
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find("in:1: "), 0U) << error.what();
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
    EXPECT_EQ(&looked.session->simulation(), body);
    EXPECT_EQ(looked.session->origin().file, looked.board.scene);
    EXPECT_TRUE(looked.session->origin().changes.empty());
  };
  expect_refused("set material.upper.poisson=0.7", "poisson");
  expect_refused("set material.upper.yungo=1", "yungo");
  expect_refused("set fracture.model=A fracture.crack=split", "model \"B\"");
  expect_refused("open " + (looked.folder / "none.toml").string(), "none.toml");
  write_text(looked.folder / "bad.toml", "mesh = 3\n");
  expect_refused("open " + (looked.folder / "bad.toml").string(), "mesh");
  expect_same_bits(RunState(looked.session->simulation()), before);
  EXPECT_THROW(parse_inputs("set", "in"), InputError);
  EXPECT_THROW(parse_inputs("set material.upper.young", "in"), InputError);
  EXPECT_THROW(parse_inputs("open", "in"), InputError);
}

TEST(ChangedBody, WhatHasNoSolutionThenOrNoDeviceIsRefusedToo) {
  Looked looked;
  looked.take("step\nremove 100\ndrive 0 0 -1e308 0");
  const auto* body = &looked.session->simulation();
  EXPECT_THROW(looked.take("set material.upper.young=7"), NumericalError);
  EXPECT_EQ(&looked.session->simulation(), body);
  EXPECT_TRUE(looked.session->origin().changes.empty());
  looked.session->can_change({looked.board.scene, {}}, [](const Origin&) -> BodyPlan {
    throw DeviceError("the device was lost");
  });
  EXPECT_THROW(looked.take("set material.upper.young=7"), DeviceError);
  EXPECT_EQ(&looked.session->simulation(), body);
  looked.take("drive 0 0 -1 0\nstep");
  EXPECT_EQ(looked.session->simulation().steps_done(), 2);
}

TEST(ChangedBody, AnotherSceneComesInItsPlace) {
  Looked looked;
  looked.take("camera 90 0 3\nset material.upper.young=6\nstep\nremove 100");
  const std::filesystem::path other = looked.folder / "other.toml";
  write_text(other, board_toml("Another") + "[time]\nsteps = 2\n");
  looked.take("open " + other.string());
  EXPECT_EQ(looked.session->problem().scene().title, "Another");
  EXPECT_EQ(looked.session->origin().file, other);
  EXPECT_TRUE(looked.session->origin().changes.empty());
  EXPECT_EQ(looked.session->look().camera.zoom, 1);
  EXPECT_TRUE(looked.session->hand().recording().empty());
  looked.take("step 2");
  looked.expect_same_bits_again();
}

struct LiveLooked : Looked {
  LiveLooked() {
    session->can_change({board.scene, {}}, [this](const Origin& origin) {
      if (holds_up.valid()) holds_up.wait();
      return plan(origin);
    });
    live.emplace(*session);
  }
  [[nodiscard]] bool within(const std::function<bool(const LiveSession::Now&)>& so) const {
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (std::chrono::steady_clock::now() < end) {
      if (so(live->now())) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  std::shared_future<void> holds_up;
  std::optional<LiveSession> live;
};

TEST(ChangedBody, WhileItIsPreparedTheOneBeforeIsShownAndNobodyWaits) {
  std::promise<void> go_on;
  LiveLooked looked;
  looked.holds_up = go_on.get_future().share();
  looked.live->post(input::Step{});
  ASSERT_TRUE(looked.within([](const auto& now) { return now.shown->report.has_value(); }));
  const auto before = looked.live->now().shown;
  looked.live->post(input::Set{{"material.upper.young=7"}});
  ASSERT_TRUE(looked.within([](const auto& now) { return !now.preparing.empty(); }));
  const auto start = std::chrono::steady_clock::now();
  const auto now = looked.live->now();
  EXPECT_EQ(now.preparing, "material.upper.young=7");
  EXPECT_EQ(now.shown, before);
  EXPECT_EQ(now.body, 0);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 5s);
  go_on.set_value();
  ASSERT_TRUE(looked.within([](const auto& n) { return n.body == 1; }));
  const auto after = looked.live->now();
  EXPECT_TRUE(after.preparing.empty());
  EXPECT_NE(after.shown->problem, before->problem);
  EXPECT_EQ(after.origin.changes, std::vector<std::string>{"material.upper.young=7"});
  EXPECT_FALSE(after.said.empty());
}

TEST(ChangedBody, ABadFilePausesIsToldAndTheBodyGoesOn) {
  LiveLooked looked;
  looked.live->pause(false);
  looked.live->post(input::Remove{{100}});
  looked.live->post(input::Open{(looked.folder / "none.msh").string()});
  ASSERT_TRUE(looked.within([](const auto& now) { return now.error.has_value(); }));
  EXPECT_TRUE(looked.live->paused());
  const auto now = looked.live->now();
  EXPECT_NE(now.error->find("none.msh"), std::string::npos) << *now.error;
  EXPECT_TRUE(now.preparing.empty());
  EXPECT_EQ(now.body, 0);
  EXPECT_EQ(now.shown->state.destroyed[100], 1);
  looked.live->post(input::Undo{});
  EXPECT_TRUE(looked.within([](const auto& n) {
    return !n.error && n.redos == 1 && n.shown->state.destroyed[100] == 0;
  }));
}

TEST(ChangedBody, AGripKeepsItsNumberForWhoeverHoldsIt) {
  LiveLooked looked;
  looked.live->post(input::Grasp{{20}, Vec3::Zero(), 0, false});
  looked.live->post(input::Release{1});
  looked.live->post(input::Grasp{{60}, Vec3::Zero(), 0, false});
  looked.live->post(input::Step{});
  ASSERT_TRUE(looked.within([](const auto& n) { return n.grips.size() == 1 && n.shown->report; }));
  ASSERT_EQ(looked.live->now().grips.front().grip, 2);
  looked.live->post(input::Set{{"material.upper.young=7"}});
  const Vec3 there(20, 52, 1);
  looked.live->post(input::Pose{2, there, {0, 0, 0, 1}});
  looked.live->post(input::Pose{1, Vec3::Zero(), {0, 0, 0, 1}});  // which was let go
  ASSERT_TRUE(looked.within([](const auto& n) { return n.body == 1; }));
  ASSERT_TRUE(looked.within([&](const auto& n) {
    return n.grips.size() == 1 && (n.grips.front().place - there).norm() < 1e-9;
  }));
  const auto now = looked.live->now();
  EXPECT_EQ(now.grips.front().grip, 2);
  EXPECT_EQ(now.grips.front().of_body, 1);
  EXPECT_FALSE(now.error) << *now.error;
  looked.live->post(input::Grasp{{20}, Vec3::Zero(), 0, false});
  ASSERT_TRUE(looked.within([](const auto& n) { return n.grips.size() == 2; }));
  EXPECT_EQ(looked.live->now().grips.back().grip, 3);
}

TEST(SceneEdit, NamesWhatDiffersAndWhetherItTakesABase) {
  const Looked looked;
  const SceneEdit is = edit_of(looked.session->problem());
  EXPECT_TRUE(changes_of(is, is).empty());
  SceneEdit edit = is;
  const auto upper = std::find_if(edit.volumes.begin(), edit.volumes.end(),
                                  [](const auto& of) { return of.volume == "upper"; });
  ASSERT_NE(upper, edit.volumes.end());
  upper->material.yield = 0.1;
  upper->material.toughness = 3;
  edit.model = FractureModel::a;
  EXPECT_FALSE(changes_stiffness(is, edit));
  EXPECT_EQ(changes_of(is, edit),
            (std::vector<std::string>{"material.\"upper\".yield=0.1",
                                      "material.\"upper\".toughness=3", "fracture.model=A"}));
  upper->material.law = MaterialLaw::neo_hookean;
  upper->material.yield.reset();  // a key cannot be taken out
  EXPECT_TRUE(changes_stiffness(is, edit));
  EXPECT_EQ(changes_of(is, edit).front(), "material.\"upper\".law=neo-hookean");
  const auto problem = read_problem(looked.board.scene, changes_of(is, edit));
  EXPECT_TRUE(problem->finite());
}

}  // namespace
}  // namespace sunder::test
