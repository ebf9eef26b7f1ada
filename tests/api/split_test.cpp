// SPDX-License-Identifier: Apache-2.0
// A body that cracks split through the C interface: its nodes become more, arrays of the mesh's
// size stay what they were.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "api/c_scene.hpp"
#include "api/guarded_bytes.hpp"

namespace sunder::test {
namespace {

constexpr std::size_t kBoardNodes = 50, kBoardTets = 96;

sunder_simulation split_board() {
  const sunder_scene scene = board_scene();
  auto fracture = model(SUNDER_FRACTURE_B);
  fracture.crack = SUNDER_CRACK_SPLIT;
  fracture.sif = SUNDER_SIF_FIELD;
  fracture.alpha = 1e-8;
  EXPECT_OK(sunder_scene_set_fracture(scene, &fracture));
  sunder_simulation simulation = nullptr;
  EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  EXPECT_OK(sunder_scene_destroy(scene));
  return simulation;
}

sunder_body body_of(sunder_simulation simulation) {
  sunder_body body = SUNDER_BODY_INIT;
  EXPECT_OK(sunder_simulation_body(simulation, &body));
  return body;
}

template <class T, class Function>
std::vector<T> array_of(sunder_simulation simulation, std::size_t size, Function function) {
  std::vector<T> values(size, T{-7});
  EXPECT_OK(function(simulation, values.data(), values.size()));
  return values;
}

class CSplit : public testing::Test {
 protected:
  ~CSplit() override { EXPECT_OK(sunder_simulation_destroy(simulation)); }
  /// Until something has split.
  void tear() {
    for (int i = 0; i < 4; ++i) ASSERT_OK(sunder_simulation_step(simulation, nullptr));
    ASSERT_GT(body_of(simulation).node_count, static_cast<int>(kBoardNodes));
  }
  sunder_simulation simulation = split_board();
};

TEST_F(CSplit, IsTheMeshBeforeItTears) {
  const sunder_body body = body_of(simulation);
  EXPECT_EQ(body.version, 0);
  EXPECT_EQ(body.node_count, static_cast<int>(kBoardNodes));
  EXPECT_EQ(body.tet_count, static_cast<int>(kBoardTets));
  EXPECT_EQ(body.crack_face_count, 0);
  EXPECT_EQ(array_of<std::int32_t>(simulation, 4 * kBoardTets, sunder_simulation_body_corners),
            board_arrays().tets);
  std::vector<std::int32_t> own(kBoardNodes);
  std::iota(own.begin(), own.end(), 0);
  EXPECT_EQ(array_of<std::int32_t>(simulation, kBoardNodes, sunder_simulation_body_parents), own);
  EXPECT_EQ(array_of<double>(simulation, 3 * kBoardNodes, sunder_simulation_body_displacement),
            std::vector<double>(3 * kBoardNodes, 0.0));
  EXPECT_OK(sunder_simulation_crack_faces(simulation, nullptr, 0));
}

TEST_F(CSplit, NodesComeAfterTheMeshsOwn) {
  tear();
  const sunder_body body = body_of(simulation);
  EXPECT_GT(body.version, 0);
  const auto nodes = static_cast<std::size_t>(body.node_count);
  const auto parents = array_of<std::int32_t>(simulation, nodes, sunder_simulation_body_parents);
  for (std::size_t n = 0; n < nodes; ++n) {
    EXPECT_EQ(n < kBoardNodes, parents[n] == static_cast<int>(n)) << n;
    ASSERT_GE(parents[n], 0);
    ASSERT_LT(parents[n], static_cast<int>(kBoardNodes));
  }
  const auto corners =
      array_of<std::int32_t>(simulation, 4 * kBoardTets, sunder_simulation_body_corners);
  const auto tets = board_arrays().tets;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_EQ(parents[static_cast<std::size_t>(corners[i])], tets[i]) << "corners stay in place";
  }
  EXPECT_NE(corners, tets);
}

// A host's array that was right at creation is filled as it was, and not a byte beyond.
TEST_F(CSplit, ArraysOfTheMeshsSizeStayAsTheyWere) {
  tear();
  GuardedBytes guarded(3 * kBoardNodes * sizeof(double), 0);
  auto* u = reinterpret_cast<double*>(guarded.data());
  EXPECT_OK(sunder_simulation_displacement(simulation, u, 3 * kBoardNodes));
  const auto nodes = static_cast<std::size_t>(body_of(simulation).node_count);
  const auto all = array_of<double>(simulation, 3 * nodes, sunder_simulation_body_displacement);
  EXPECT_TRUE(std::equal(u, u + 3 * kBoardNodes, all.begin()));
  EXPECT_EQ(sunder_simulation_displacement(simulation, u, 3 * nodes), SUNDER_ERROR_SIZE);
  EXPECT_EQ(sunder_simulation_body_displacement(simulation, u, 3 * kBoardNodes), SUNDER_ERROR_SIZE);
  std::vector<double> stress(6 * kBoardTets);
  EXPECT_OK(sunder_simulation_stress(simulation, stress.data(), stress.size()));
  std::vector<std::uint8_t> destroyed(kBoardTets, 1);
  EXPECT_OK(sunder_simulation_destroyed(simulation, destroyed.data(), destroyed.size()));
  EXPECT_EQ(std::ranges::count(destroyed, 1), 0);
}

TEST_F(CSplit, LipsLayAtTheSamePlacesAndGape) {
  tear();
  const sunder_body body = body_of(simulation);
  const auto nodes = static_cast<std::size_t>(body.node_count);
  ASSERT_GT(body.crack_face_count, 0);
  const auto parents = array_of<std::int32_t>(simulation, nodes, sunder_simulation_body_parents);
  const auto u = array_of<double>(simulation, 3 * nodes, sunder_simulation_body_displacement);
  const auto faces =
      array_of<std::int32_t>(simulation, 7 * static_cast<std::size_t>(body.crack_face_count),
                             sunder_simulation_crack_faces);
  std::int32_t cracks = 0;
  EXPECT_OK(sunder_simulation_crack_count(simulation, &cracks));
  double widest = 0;
  for (std::size_t f = 0; f < faces.size(); f += 7) {
    EXPECT_GE(faces[f], 0);
    EXPECT_LT(faces[f], cracks);
    for (std::size_t i = 1; i <= 3; ++i) {
      const auto left = static_cast<std::size_t>(faces[f + i]);
      const auto right = static_cast<std::size_t>(faces[f + i + 3]);
      EXPECT_EQ(parents.at(left), parents.at(right));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        widest = std::max(widest, std::abs(u[3 * left + axis] - u[3 * right + axis]));
      }
    }
  }
  EXPECT_GT(widest, 0.1);
}

TEST_F(CSplit, EventsSayThatNothingWasDestroyed) {
  tear();
  std::int32_t count = 0;
  ASSERT_OK(sunder_simulation_event_count(simulation, &count));
  ASSERT_GT(count, 0);
  for (std::int32_t i = 0; i < count; ++i) {
    sunder_event event = SUNDER_EVENT_INIT;
    ASSERT_OK(sunder_simulation_event_at(simulation, i, &event));
    EXPECT_EQ(event.lives, 1);
    EXPECT_EQ(event.element == -1, event.cause == SUNDER_CAUSE_SIF);
    EXPECT_GE(event.crack, 0);
  }
}

// A blade opens faces and takes no element; it is undone, done again and told to another one.
TEST_F(CSplit, ABladeOpensFacesAndAGripHoldsALip) {
  ASSERT_OK(sunder_simulation_keep_history(simulation, 8));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  const double swept[18] = {-1, 4.1, -1, -1,  4.1, 2, 5.2, 4.3, -1,
                            -1, 4.1, 2,  5.2, 4.3, 2, 5.2, 4.3, -1};
  const std::int32_t torn = body_of(simulation).crack_face_count;  // by itself
  std::int32_t opened = 0, rows = 0, cracks = 0;
  ASSERT_OK(sunder_simulation_cut(simulation, swept, 18, &opened));
  EXPECT_GT(opened, 3);
  const sunder_body cut = body_of(simulation);
  EXPECT_EQ(cut.crack_face_count, torn + opened);
  EXPECT_GT(cut.node_count, static_cast<int>(kBoardNodes));
  std::vector<std::uint8_t> destroyed(kBoardTets, 1);
  EXPECT_OK(sunder_simulation_destroyed(simulation, destroyed.data(), destroyed.size()));
  EXPECT_EQ(std::ranges::count(destroyed, 1), 0);
  sunder_event event = SUNDER_EVENT_INIT;
  ASSERT_OK(sunder_simulation_event_count(simulation, &rows));
  ASSERT_OK(sunder_simulation_event_at(simulation, rows - 1, &event));
  ASSERT_OK(sunder_simulation_crack_count(simulation, &cracks));
  EXPECT_EQ(event.cause, SUNDER_CAUSE_SCRIPT);
  EXPECT_EQ(event.lives, 1);
  EXPECT_EQ(event.element, -1);
  EXPECT_EQ(event.crack, cracks - 1);
  std::int32_t grip = 0, events = 0, replayed = 0;
  const double tip[3] = {2.5, 2.5, 0.5};
  ASSERT_OK(sunder_simulation_grasp_near(simulation, tip, 1.5, 1, &grip));
  ASSERT_OK(sunder_simulation_undo(simulation, 2, &events, &replayed));
  EXPECT_EQ(events, 1);
  EXPECT_EQ(body_of(simulation).crack_face_count, torn);
  ASSERT_OK(sunder_simulation_redo(simulation, 1, &events));
  EXPECT_EQ(body_of(simulation).crack_face_count, torn + opened);
  const double flat[9] = {-1, -1, 0.51, 11, -1, 0.51, -1, 9, 0.51};
  EXPECT_EQ(sunder_simulation_cut(simulation, flat, 9, &opened), SUNDER_ERROR_ORDER);
}

// The body hangs on its supports by the corners that elements have now.
TEST_F(CSplit, SupportsHoldWhatTheForcepsPull) {
  tear();
  std::vector<double> support(3);
  ASSERT_OK(sunder_simulation_support_reaction(simulation, support.data(), 3));
  EXPECT_NEAR(support[0], 0, 1e-5);
  EXPECT_NEAR(support[1], 40, 1e-5);
}

TEST(CSplitCallers, OlderOnesGetEventsAsTheyWere) {
  const sunder_simulation simulation = split_board();
  for (int i = 0; i < 4; ++i) ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  sunder_event event{};
  event.struct_size = offsetof(sunder_event, lives);
  event.lives = 9;  // not the caller's memory any more
  ASSERT_OK(sunder_simulation_event_at(simulation, 0, &event));
  EXPECT_EQ(event.lives, 9);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

}  // namespace
}  // namespace sunder::test
