// SPDX-License-Identifier: Apache-2.0
// A live body through the C interface: cut, go back and forth, record, draw, bound a step.
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "api/c_scene.hpp"

namespace sunder::test {
namespace {

constexpr std::size_t kNodes = 50, kTets = 96;

/// All that a host reads of a state.
struct Read {
  explicit Read(sunder_simulation s) {
    EXPECT_OK(sunder_simulation_displacement(s, u.data(), u.size()));
    EXPECT_OK(sunder_simulation_stress(s, stress.data(), stress.size()));
    EXPECT_OK(sunder_simulation_destroyed(s, gone.data(), gone.size()));
    EXPECT_OK(sunder_simulation_reactions(s, reactions.data(), reactions.size()));
    EXPECT_OK(sunder_simulation_event_count(s, &events));
  }
  bool operator==(const Read&) const = default;
  std::vector<double> u = std::vector<double>(3 * kNodes), stress = std::vector<double>(6 * kTets),
                      reactions = std::vector<double>(3);
  std::vector<std::uint8_t> gone = std::vector<std::uint8_t>(kTets);
  std::int32_t events = 0;
};

class CLive : public testing::Test {
 protected:
  CLive() { EXPECT_OK(sunder_simulation_keep_history(simulation, 100)); }
  ~CLive() override { EXPECT_OK(sunder_simulation_destroy(simulation)); }
  /// Until something has broken.
  sunder_step tear() {
    sunder_step step = SUNDER_STEP_INIT;
    while (step.events == 0) EXPECT_OK(sunder_simulation_step(simulation, &step));
    return step;
  }
  std::vector<std::uint8_t> stored() {
    std::size_t length = 0;
    EXPECT_OK(sunder_simulation_store(simulation, nullptr, 0, &length));
    std::vector<std::uint8_t> bytes(length);
    EXPECT_OK(sunder_simulation_store(simulation, bytes.data(), bytes.size(), &length));
    return bytes;
  }
  sunder_simulation simulation = board_simulation();
};

TEST_F(CLive, UndoAndRedoComeToTheSameBits) {
  const Read start(simulation);
  const sunder_step step = tear();
  const Read torn(simulation);
  std::int32_t undos = 0, redos = 0, events = 0, replayed = -1;
  ASSERT_OK(sunder_simulation_history(simulation, &undos, &redos));
  EXPECT_EQ(undos, 1);
  EXPECT_EQ(redos, 0);
  ASSERT_OK(sunder_simulation_undo(simulation, 1, &events, &replayed));
  EXPECT_EQ(events, step.events);
  EXPECT_EQ(replayed, 0);
  EXPECT_EQ(Read(simulation).events, 0);
  EXPECT_FALSE(Read(simulation) == torn);
  ASSERT_OK(sunder_simulation_redo(simulation, 1, &events));
  EXPECT_EQ(events, step.events);
  EXPECT_TRUE(Read(simulation) == torn);
  EXPECT_EQ(sunder_simulation_undo(simulation, 2, nullptr, nullptr), SUNDER_ERROR_ORDER);
  EXPECT_TRUE(Read(simulation) == torn);
}

TEST_F(CLive, MarksAreComeBackToFromWherever) {
  std::int32_t early = 0, late = 0, replayed = 0;
  ASSERT_OK(sunder_simulation_save(simulation, &early));
  const Read start(simulation);
  tear();
  ASSERT_OK(sunder_simulation_save(simulation, &late));
  EXPECT_NE(early, late);
  const Read torn(simulation);
  ASSERT_OK(sunder_simulation_restore(simulation, early, &replayed));
  EXPECT_TRUE(Read(simulation) == start);
  const double gentle[3] = {0, -0.1, 0};
  ASSERT_OK(sunder_simulation_drive(simulation, 0, gentle));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  ASSERT_OK(sunder_simulation_restore(simulation, late, nullptr));
  EXPECT_TRUE(Read(simulation) == torn);
  ASSERT_OK(sunder_simulation_forget(simulation, early));
  EXPECT_EQ(sunder_simulation_restore(simulation, early, nullptr), SUNDER_ERROR_VALUE);
  EXPECT_EQ(sunder_simulation_forget(simulation, early), SUNDER_ERROR_VALUE);
}

TEST_F(CLive, RecordingsAreToldToAnother) {
  tear();
  const std::int32_t elements[] = {90, 91};
  ASSERT_OK(sunder_simulation_remove(simulation, elements, 2));
  auto bytes = stored();
  const sunder_simulation other = board_simulation();
  ASSERT_OK(sunder_simulation_keep_history(other, 0));
  ASSERT_OK(sunder_simulation_load(other, bytes.data(), bytes.size()));
  EXPECT_TRUE(Read(other) == Read(simulation));
  bytes[bytes.size() / 2] ^= 1;
  EXPECT_EQ(sunder_simulation_load(other, bytes.data(), bytes.size()), SUNDER_ERROR_INPUT);
  EXPECT_TRUE(Read(other) == Read(simulation));
  std::size_t length = 0;
  EXPECT_EQ(sunder_simulation_store(simulation, bytes.data(), 5, &length), SUNDER_ERROR_SIZE);
  EXPECT_EQ(length, bytes.size());
  EXPECT_OK(sunder_simulation_destroy(other));
}

TEST_F(CLive, NamesWhatItMayCut) {
  const std::int32_t elements[] = {0, 3};
  const double gentle[3] = {0, -0.1, 0}, corner[3] = {0, 0, 0};
  ASSERT_OK(sunder_simulation_drive(simulation, 0, gentle));
  ASSERT_OK(sunder_simulation_prepare(simulation, elements, 2));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  const Read before(simulation);
  std::int32_t count = 0, less = 0;
  ASSERT_OK(sunder_simulation_prepare_near(simulation, corner, 1, &count));
  EXPECT_GT(count, 0);
  EXPECT_LT(count, kTets);
  ASSERT_OK(sunder_simulation_remove(simulation, elements, 1));
  ASSERT_OK(sunder_simulation_prepare_near(simulation, corner, 1, &less));
  EXPECT_EQ(less, count - 1);
  ASSERT_OK(sunder_simulation_prepare_near(simulation, corner, 1, nullptr));
  ASSERT_OK(sunder_simulation_prepare(simulation, nullptr, 0));
  ASSERT_OK(sunder_simulation_undo(simulation, 1, nullptr, nullptr));
  EXPECT_TRUE(Read(simulation) == before);
}

TEST_F(CLive, RemovesAndCuts) {
  const std::int32_t elements[] = {0, 3};
  const double gentle[3] = {0, -0.1, 0};
  ASSERT_OK(sunder_simulation_drive(simulation, 0, gentle));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  ASSERT_OK(sunder_simulation_remove(simulation, elements, 2));
  Read read(simulation);
  EXPECT_GE(std::ranges::count(read.gone, 1), 2);
  EXPECT_EQ(read.gone[0], 1);
  EXPECT_EQ(read.gone[3], 1);
  EXPECT_EQ(sunder_simulation_remove(simulation, elements, 1), SUNDER_ERROR_ORDER);
  EXPECT_OK(sunder_simulation_remove(simulation, nullptr, 0));
  // A blade through the body in the plane x = 1, all of its height.
  const double swept[18] = {1, -99, -9, 1, -99, 9, 1, 99, -9, 1, -99, 9, 1, 99, 9, 1, 99, -9};
  std::int32_t removed = 0;
  ASSERT_OK(sunder_simulation_cut(simulation, swept, 18, &removed));
  EXPECT_GT(removed, 4);
  const Read cut(simulation);
  EXPECT_EQ(std::ranges::count(cut.gone, 1), std::ranges::count(read.gone, 1) + removed);
  sunder_event event = SUNDER_EVENT_INIT;
  ASSERT_OK(sunder_simulation_event_at(simulation, cut.events - 1, &event));
  EXPECT_EQ(event.cause, SUNDER_CAUSE_SCRIPT);
  std::int32_t events = 0;
  ASSERT_OK(sunder_simulation_undo(simulation, 1, &events, nullptr));
  EXPECT_EQ(events, 1);
  EXPECT_TRUE(Read(simulation) == read);
}

/// Near the lower left corner, whatever tears at the right.
constexpr double kHere[3] = {0, 0, 0.5};

TEST_F(CLive, GraspsPosesAndLetsGo) {
  const double gentle[3] = {0, -0.1, 0};
  ASSERT_OK(sunder_simulation_drive(simulation, 0, gentle));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  const Read before(simulation);
  std::int32_t grip = -1;
  ASSERT_OK(sunder_simulation_grasp_near(simulation, kHere, 1, 1, &grip));
  EXPECT_EQ(grip, 1);
  EXPECT_TRUE(Read(simulation) == before) << "nothing moves by it";
  std::size_t count = 0;
  ASSERT_OK(sunder_simulation_held_nodes(simulation, grip, nullptr, 0, &count));
  ASSERT_EQ(count, 2U);
  std::int32_t held[2] = {};
  EXPECT_EQ(sunder_simulation_held_nodes(simulation, grip, held, 1, &count), SUNDER_ERROR_SIZE);
  ASSERT_OK(sunder_simulation_held_nodes(simulation, grip, held, 2, &count));
  EXPECT_EQ(held[0], 0);
  double place[3] = {}, force[3] = {1, 1, 1}, torque[3] = {1, 1, 1};
  ASSERT_OK(sunder_simulation_grip_place(simulation, grip, place));
  EXPECT_TRUE(std::ranges::equal(place, kHere));
  ASSERT_OK(sunder_simulation_wrench(simulation, grip, force, torque));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(std::abs(force[i]) + std::abs(torque[i]), 0);
  // A right angle about z, and down.
  const double to[3] = {0, -0.02, 0.5}, turn[4] = {0, 0, 1, 1};
  ASSERT_OK(sunder_simulation_pose(simulation, grip, to, turn));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  const Read posed(simulation);
  const double x = before.u[0], y = before.u[1];  // of node 0, at 0, 0, 0
  EXPECT_NEAR(posed.u[0], -y, 1e-14);
  EXPECT_NEAR(posed.u[1], x - 0.02, 1e-14);
  ASSERT_OK(sunder_simulation_wrench(simulation, grip, force, torque));
  EXPECT_LT(force[1], 0);
  ASSERT_OK(sunder_simulation_pose(simulation, grip, to, nullptr));
  ASSERT_OK(sunder_simulation_release(simulation, grip));
  EXPECT_EQ(sunder_simulation_release(simulation, grip), SUNDER_ERROR_ORDER);
  EXPECT_EQ(sunder_simulation_wrench(simulation, grip, force, torque), SUNDER_ERROR_ORDER);
  EXPECT_EQ(sunder_simulation_pose(simulation, grip, to, nullptr), SUNDER_ERROR_ORDER);
  ASSERT_OK(sunder_simulation_undo(simulation, 2, nullptr, nullptr));
  EXPECT_TRUE(Read(simulation) == before);
  ASSERT_OK(sunder_simulation_redo(simulation, 1, nullptr));
  EXPECT_TRUE(Read(simulation) == posed);
  EXPECT_OK(sunder_simulation_release(simulation, grip));
}

TEST_F(CLive, PushesMovesAndDrops) {
  const double gentle[3] = {0, -0.1, 0}, force[3] = {0.01, 0, 0.02};
  ASSERT_OK(sunder_simulation_drive(simulation, 0, gentle));
  const std::int32_t nodes[] = {1, 26}, others[] = {0};
  std::int32_t push = -1, next = -1;
  ASSERT_OK(sunder_simulation_push(simulation, nodes, 2, force, &push));
  EXPECT_EQ(push, 1);
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  const Read pushed(simulation);
  ASSERT_OK(sunder_simulation_move(simulation, push, others, 1, force));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  EXPECT_FALSE(Read(simulation) == pushed);
  ASSERT_OK(sunder_simulation_drop(simulation, push));
  EXPECT_EQ(sunder_simulation_drop(simulation, push), SUNDER_ERROR_ORDER);
  EXPECT_EQ(sunder_simulation_move(simulation, push, others, 1, force), SUNDER_ERROR_ORDER);
  ASSERT_OK(sunder_simulation_push(simulation, nodes, 2, force, &next));
  EXPECT_EQ(next, 2) << "no id comes twice";
  EXPECT_EQ(sunder_simulation_release(simulation, next), SUNDER_ERROR_ORDER) << "a push";
}

TEST_F(CLive, RefusedGripsChangeNothing) {
  std::int32_t grip = -7;
  const std::int32_t twice[] = {3, 3}, held[] = {24}, one[] = {3};
  const Read before(simulation);
  EXPECT_EQ(sunder_simulation_grasp(simulation, twice, 2, 0, &grip), SUNDER_ERROR_ORDER);
  EXPECT_EQ(sunder_simulation_grasp(simulation, held, 1, 0, &grip), SUNDER_ERROR_ORDER);
  EXPECT_EQ(sunder_simulation_grasp(simulation, nullptr, 0, 0, &grip), SUNDER_ERROR_ORDER);
  EXPECT_EQ(grip, -7);
  ASSERT_OK(sunder_simulation_grasp(simulation, one, 1, 0, &grip));
  std::int32_t other = -7;
  EXPECT_EQ(sunder_simulation_grasp(simulation, one, 1, 0, &other), SUNDER_ERROR_ORDER);
  EXPECT_EQ(other, -7);
  const double place[3] = {0, 0, 0}, turn[4] = {0, 0, 0.1, 1};
  EXPECT_EQ(sunder_simulation_pose(simulation, grip, place, turn), SUNDER_ERROR_ORDER) << "points";
  EXPECT_TRUE(Read(simulation) == before);
}

// A grip of the scene: its reaction is gone, and undoing brings the grip back.
TEST(CLiveScene, ItsGripsLetGo) {
  const sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, 4, -1);
  sunder_instrument held = corner_pull();
  held.kind = SUNDER_DISPLACEMENT;
  held.nodes = box(-0.01, -0.01, 0.01, 0.01);
  held.value[0] = -0.3, held.value[1] = 0;
  ASSERT_OK(sunder_scene_add_instrument(scene, &held, nullptr));
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  ASSERT_OK(sunder_scene_destroy(scene));
  ASSERT_OK(sunder_simulation_keep_history(simulation, 100));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  double before[6], after[6];
  ASSERT_OK(sunder_simulation_reactions(simulation, before, 6));
  EXPECT_NE(before[3], 0);
  EXPECT_EQ(sunder_simulation_release(simulation, 0), SUNDER_ERROR_ORDER) << "a pull";
  ASSERT_OK(sunder_simulation_release(simulation, 1));
  EXPECT_EQ(sunder_simulation_release(simulation, 1), SUNDER_ERROR_ORDER);
  const double way[3] = {0, 0, 0};
  EXPECT_EQ(sunder_simulation_drive(simulation, 1, way), SUNDER_ERROR_ORDER);
  sunder_step step = SUNDER_STEP_INIT;
  ASSERT_OK(sunder_simulation_step(simulation, &step));
  EXPECT_EQ(step.new_bases, 0);
  EXPECT_EQ(step.ms_new_bases, 0);
  ASSERT_OK(sunder_simulation_reactions(simulation, after, 6));
  for (int axis = 3; axis < 6; ++axis) EXPECT_EQ(after[axis], 0);
  std::int32_t events = 0, replayed = 0;
  ASSERT_OK(sunder_simulation_undo(simulation, 1, &events, &replayed));
  ASSERT_OK(sunder_simulation_reactions(simulation, after, 6));
  for (int axis = 0; axis < 6; ++axis) EXPECT_EQ(after[axis], before[axis]);
  ASSERT_OK(sunder_simulation_destroy(simulation));
}

TEST_F(CLive, StepsAreBoundByTime) {
  sunder_step step = SUNDER_STEP_INIT;
  while (step.events == 0) ASSERT_OK(sunder_simulation_step_within(simulation, 1e-6, &step));
  EXPECT_EQ(step.events, 1);
  EXPECT_EQ(step.out_of_time, 1);
  EXPECT_NE(warnings_of(simulation).find("ended by time"), std::string::npos);
}

TEST(CWarmUp, IsForAnyMoment) {
  const sunder_simulation simulation = board_simulation(), cold = board_simulation();
  EXPECT_OK(sunder_simulation_warm_up(simulation));
  for (int i = 0; i < 4; ++i) {
    EXPECT_OK(sunder_simulation_step(simulation, nullptr));
    EXPECT_OK(sunder_simulation_step(cold, nullptr));
  }
  EXPECT_TRUE(Read(simulation) == Read(cold));
  EXPECT_OK(sunder_simulation_warm_up(simulation));
  EXPECT_OK(sunder_simulation_destroy(simulation));
  EXPECT_OK(sunder_simulation_destroy(cold));
}

TEST_F(CLive, SurfaceIsFollowedByItsChanges) {
  sunder_surface surface = SUNDER_SURFACE_INIT;
  std::size_t count = 0;
  EXPECT_EQ(sunder_simulation_surface_changes(simulation, 0, nullptr, 0, &count),
            SUNDER_ERROR_ORDER);
  ASSERT_OK(sunder_simulation_surface(simulation, &surface));
  EXPECT_EQ(surface.version, 1U);
  EXPECT_EQ(surface.node_count, static_cast<int>(kNodes));
  EXPECT_EQ(surface.triangle_count, 2 * (2 * 16 + 4 * 4));
  std::vector<sunder_triangle> drawn(static_cast<std::size_t>(surface.triangle_count));
  ASSERT_OK(sunder_simulation_surface_changes(simulation, 0, drawn.data(), drawn.size(), &count));
  ASSERT_EQ(count, drawn.size());
  const std::int32_t elements[] = {40};
  ASSERT_OK(sunder_simulation_remove(simulation, elements, 1));
  const std::uint64_t version = surface.version;
  ASSERT_OK(sunder_simulation_surface(simulation, &surface));
  EXPECT_GT(surface.version, version);
  std::array<sunder_triangle, 16> changed{};
  EXPECT_EQ(sunder_simulation_surface_changes(simulation, version, changed.data(), 1, &count),
            SUNDER_ERROR_SIZE);
  ASSERT_OK(sunder_simulation_surface_changes(simulation, version, changed.data(), changed.size(),
                                              &count));
  drawn.resize(static_cast<std::size_t>(surface.triangle_count));
  for (std::size_t i = 0; i < count; ++i) {
    if (changed[i].place < surface.triangle_count) {
      drawn[static_cast<std::size_t>(changed[i].place)] = changed[i];
    }
  }
  std::vector<sunder_triangle> all(drawn.size());
  ASSERT_OK(sunder_simulation_surface_changes(simulation, 0, all.data(), all.size(), &count));
  for (std::size_t t = 0; t < all.size(); ++t) {
    EXPECT_TRUE(std::ranges::equal(all[t].nodes, drawn[t].nodes)) << t;
    EXPECT_NE(all[t].element, 40);
  }
  EXPECT_TRUE(std::ranges::any_of(all, [](const auto& t) { return t.opened == 1; }));
  std::vector<float> places(3 * kNodes), normals(3 * kNodes);
  ASSERT_OK(
      sunder_simulation_surface_points(simulation, places.data(), normals.data(), places.size()));
  ASSERT_OK(sunder_simulation_surface_points(simulation, places.data(), nullptr, places.size()));
  EXPECT_EQ(sunder_simulation_surface_points(simulation, places.data(), nullptr, 3),
            SUNDER_ERROR_SIZE);
}

TEST_F(CLive, SkinIsCarried) {
  const double vertices[] = {5, 5, 0.5, 1, 9.5, 0.25};
  float places[6] = {};
  std::uint8_t lives[2] = {7, 7};
  EXPECT_EQ(sunder_simulation_skin(simulation, places, 6, lives), SUNDER_ERROR_ORDER);
  ASSERT_OK(sunder_simulation_set_skin(simulation, vertices, 6));
  ASSERT_OK(sunder_simulation_skin(simulation, places, 6, lives));
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(places[i], vertices[i], 1e-6);
  EXPECT_EQ(lives[0] + lives[1], 2);
  EXPECT_EQ(sunder_simulation_skin(simulation, places, 3, nullptr), SUNDER_ERROR_SIZE);
}

// In a scene in which nothing breaks it has to be said beforehand.
TEST(CLiveScene, MayBeCut) {
  for (const std::int32_t live : {0, 1}) {
    const sunder_scene scene = board_scene();
    const auto fracture = model(SUNDER_FRACTURE_NONE);
    EXPECT_OK(sunder_scene_set_fracture(scene, &fracture));
    EXPECT_OK(sunder_scene_set_live(scene, live));
    sunder_simulation simulation = nullptr;
    ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
    const std::int32_t element = 7;
    EXPECT_EQ(sunder_simulation_remove(simulation, &element, 1),
              live ? SUNDER_OK : SUNDER_ERROR_ORDER);
    EXPECT_OK(sunder_simulation_destroy(simulation));
    EXPECT_OK(sunder_scene_destroy(scene));
  }
}

}  // namespace
}  // namespace sunder::test
