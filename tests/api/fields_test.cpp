// SPDX-License-Identifier: Apache-2.0
// What comes out: fields that fit each other, driven instruments, attribution.
#include <cmath>
#include <numeric>

#include "api/c_scene.hpp"

namespace sunder::test {
namespace {

std::vector<double> displacement(sunder_simulation simulation) {
  std::vector<double> u(150, -1.0);
  EXPECT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
  return u;
}

TEST(CFields, AreZeroBeforeTheFirstStep) {
  const sunder_simulation simulation = board_simulation();
  EXPECT_EQ(displacement(simulation), std::vector<double>(150, 0.0));
  std::vector<double> stress(576, 1.0), forces(3, 1.0);
  EXPECT_OK(sunder_simulation_stress(simulation, stress.data(), stress.size()));
  EXPECT_EQ(stress, std::vector<double>(576, 0.0));
  EXPECT_OK(sunder_simulation_reactions(simulation, forces.data(), 3));
  EXPECT_EQ(forces, std::vector<double>(3, 0.0));
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST(CFields, FitEachOtherAfterATear) {
  const sunder_simulation simulation = board_simulation();
  sunder_step step{};
  step.struct_size = sizeof step;
  for (int i = 0; i < 4; ++i) ASSERT_OK(sunder_simulation_step(simulation, &step));
  ASSERT_GT(step.destroyed, 0);
  std::vector<double> ratio(96), shear(96), forces(3), support(3);
  std::vector<std::uint8_t> destroyed(96);
  ASSERT_OK(sunder_simulation_destroyed(simulation, destroyed.data(), 96));
  EXPECT_EQ(std::accumulate(destroyed.begin(), destroyed.end(), 0), step.destroyed);
  ASSERT_OK(sunder_simulation_yield_ratio(simulation, ratio.data(), 96));
  ASSERT_OK(sunder_simulation_max_shear(simulation, shear.data(), 96));
  EXPECT_NEAR(*std::max_element(ratio.begin(), ratio.end()), step.max_yield_ratio, 1e-12);
  for (std::size_t e = 0; e < 96; ++e) {
    EXPECT_NEAR(ratio[e], destroyed[e] ? 0.0 : shear[e] / 2, 1e-12);
  }
  ASSERT_OK(sunder_simulation_reactions(simulation, forces.data(), 3));
  ASSERT_OK(sunder_simulation_support_reaction(simulation, support.data(), 3));
  EXPECT_DOUBLE_EQ(forces[1], -40);
  EXPECT_NEAR(support[1], 40, 1e-5);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

std::vector<double> lent(sunder_simulation simulation, sunder_field field,
                         const double** where = nullptr) {
  const double* values = nullptr;
  std::size_t size = 0;
  EXPECT_OK(sunder_simulation_lend(simulation, field, &values, &size));
  if (where) *where = values;
  return {values, values + size};
}

TEST(CFields, LentAreThoseThatAreRead) {
  const sunder_simulation simulation = board_simulation();
  for (int i = 0; i < 4; ++i) ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  EXPECT_EQ(lent(simulation, SUNDER_FIELD_DISPLACEMENT), displacement(simulation));
  std::vector<double> stress(576), ratio(96), shear(96);
  ASSERT_OK(sunder_simulation_stress(simulation, stress.data(), 576));
  ASSERT_OK(sunder_simulation_yield_ratio(simulation, ratio.data(), 96));
  ASSERT_OK(sunder_simulation_max_shear(simulation, shear.data(), 96));
  EXPECT_EQ(lent(simulation, SUNDER_FIELD_STRESS), stress);
  EXPECT_EQ(lent(simulation, SUNDER_FIELD_YIELD_RATIO), ratio);
  EXPECT_EQ(lent(simulation, SUNDER_FIELD_MAX_SHEAR), shear);
  std::vector<std::uint8_t> destroyed(96);
  ASSERT_OK(sunder_simulation_destroyed(simulation, destroyed.data(), 96));
  const std::uint8_t* values = nullptr;
  std::size_t size = 0;
  ASSERT_OK(sunder_simulation_lend_destroyed(simulation, &values, &size));
  EXPECT_EQ(std::vector<std::uint8_t>(values, values + size), destroyed);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

// The address sanitizer looks at the same test: nobody reads what was given back.
TEST(CFields, LentStayAsTheyWereUntilTheyAreLentAgain) {
  const sunder_simulation simulation = board_simulation();
  const double *first = nullptr, *second = nullptr;
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  const std::vector<double> before = lent(simulation, SUNDER_FIELD_DISPLACEMENT, &first);
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  static_cast<void>(lent(simulation, SUNDER_FIELD_STRESS));
  EXPECT_EQ(std::vector<double>(first, first + before.size()), before);
  EXPECT_NE(lent(simulation, SUNDER_FIELD_DISPLACEMENT, &second), before);
  EXPECT_EQ(first, second);
  EXPECT_EQ(std::vector<double>(first, first + before.size()), displacement(simulation));
  const double* untouched = first;
  std::size_t size = 7;
  EXPECT_EQ(sunder_simulation_lend(simulation, SUNDER_FIELD_VELOCITY, &untouched, &size),
            SUNDER_ERROR_ORDER);
  EXPECT_EQ(untouched, first);
  EXPECT_EQ(size, 7U);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST(CFields, EventsTellCauseOrderAndK) {
  const sunder_simulation simulation = board_simulation();
  for (int i = 0; i < 4; ++i) ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  std::int32_t count = 0, cracks = 0;
  ASSERT_OK(sunder_simulation_event_count(simulation, &count));
  ASSERT_GT(count, 1);
  std::vector<std::uint8_t> destroyed(96);
  ASSERT_OK(sunder_simulation_destroyed(simulation, destroyed.data(), 96));
  int last_event = 0;
  for (std::int32_t i = 0; i < count; ++i) {
    sunder_event event{};
    event.struct_size = sizeof event;
    ASSERT_OK(sunder_simulation_event_at(simulation, i, &event));
    EXPECT_EQ(event.order, i);
    EXPECT_EQ(destroyed[static_cast<std::size_t>(event.element)], 1);
    EXPECT_GE(event.event, last_event);
    last_event = event.event;
    EXPECT_GE(event.ratio, 1.0);
    EXPECT_EQ(event.has_sif, event.cause == SUNDER_CAUSE_SIF ? 1 : 0);
    EXPECT_EQ(event.k > 0, event.cause == SUNDER_CAUSE_SIF);
    EXPECT_EQ(event.instrument, -1) << "attribution was not asked for";
  }
  ASSERT_OK(sunder_simulation_crack_count(simulation, &cracks));
  ASSERT_GT(cracks, 0);
  sunder_crack crack{};
  crack.struct_size = sizeof crack;
  ASSERT_OK(sunder_simulation_crack_at(simulation, 0, &crack));
  std::vector<double> path(3 * static_cast<std::size_t>(crack.path_count));
  ASSERT_OK(sunder_simulation_crack_path(simulation, 0, path.data(), path.size()));
  double length = 0;
  for (std::size_t p = 3; p < path.size(); p += 3) {
    length += std::hypot(path[p] - path[p - 3], path[p + 1] - path[p - 2]);
  }
  EXPECT_NEAR(length, crack.length, 1e-12);
  std::vector<std::int32_t> elements(static_cast<std::size_t>(crack.element_count));
  ASSERT_OK(sunder_simulation_crack_elements(simulation, 0, elements.data(), elements.size()));
  for (const std::int32_t e : elements) EXPECT_EQ(destroyed[static_cast<std::size_t>(e)], 1);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST(CFields, ADrivenInstrumentActsAsItsOwnScene) {
  const sunder_scene soft = board_scene(SUNDER_BACKEND_CPU, 4, -1);
  const sunder_scene other = board_scene(SUNDER_BACKEND_CPU, 4, 12);
  sunder_simulation driven = nullptr, scripted = nullptr;
  ASSERT_OK(sunder_simulation_create(soft, nullptr, &driven));
  ASSERT_OK(sunder_simulation_create(other, nullptr, &scripted));
  for (int i = 0; i < 4; ++i) {
    const double force[3] = {0, 3.0 * (i + 1), 0};  // the other scene's ramp
    ASSERT_OK(sunder_simulation_drive(driven, 0, force));
    ASSERT_OK(sunder_simulation_step(driven, nullptr));
    ASSERT_OK(sunder_simulation_step(scripted, nullptr));
    EXPECT_EQ(displacement(driven), displacement(scripted)) << i;
  }
  for (const sunder_simulation s : {driven, scripted}) EXPECT_OK(sunder_simulation_destroy(s));
  for (const sunder_scene s : {soft, other}) EXPECT_OK(sunder_scene_destroy(s));
}

/// First rupture of a board that two instruments pull: forces at the lower right and lower left.
sunder_event first_rupture(double right, double left, bool left_grips = false) {
  const sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, 4, right);
  sunder_instrument second = corner_pull();
  second.name = "second";
  second.nodes = box(-0.01, -0.01, 0.01, 0.01);
  second.value[1] = left;
  second.axes = SUNDER_AXIS_Y;
  if (left_grips) second.kind = SUNDER_DISPLACEMENT;
  EXPECT_OK(sunder_scene_add_instrument(scene, &second, nullptr));
  auto fracture = model(SUNDER_FRACTURE_B);
  fracture.attribution = 1;
  EXPECT_OK(sunder_scene_set_fracture(scene, &fracture));
  sunder_simulation simulation = nullptr;
  EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  for (int i = 0; i < 4; ++i) EXPECT_OK(sunder_simulation_step(simulation, nullptr));
  sunder_event event{};
  event.struct_size = sizeof event;
  EXPECT_OK(sunder_simulation_event_at(simulation, 0, &event));
  EXPECT_OK(sunder_simulation_destroy(simulation));
  EXPECT_OK(sunder_scene_destroy(scene));
  return event;
}

TEST(CAttribution, NamesTheInstrumentThatPullsHarder) {
  const sunder_event right = first_rupture(-60, -5), left = first_rupture(-5, -60);
  EXPECT_EQ(right.instrument, 0);
  EXPECT_EQ(left.instrument, 1);
  EXPECT_GT(right.instrument_share, 0.5);
  EXPECT_GT(left.instrument_share, 0.5);
}

TEST(CAttribution, GivesAllToTheOnlyOneThatActs) {
  const sunder_event right = first_rupture(-60, 0);
  EXPECT_EQ(right.instrument, 0);
  EXPECT_NEAR(right.instrument_share, 1.0, 1e-9);
  const sunder_event grip = first_rupture(0, -8, true);
  EXPECT_EQ(grip.instrument, 1);
  EXPECT_NEAR(grip.instrument_share, 1.0, 1e-9);
}

}  // namespace
}  // namespace sunder::test
