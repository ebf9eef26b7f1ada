// SPDX-License-Identifier: Apache-2.0
// Versions of structs, texts and error texts.
#include <cstddef>
#include <cstring>
#include <string>

#include "api/c_scene.hpp"

namespace sunder::test {
namespace {

class CStructs : public testing::Test {
 protected:
  ~CStructs() override { EXPECT_OK(sunder_scene_destroy(scene)); }
  sunder_scene scene = board_scene();
};

TEST_F(CStructs, TakeOptionsOfANewerCallerThatSetsNothingNew) {
  struct Newer {
    sunder_solver_options known;
    double unknown;
  } newer{on(SUNDER_BACKEND_CPU), 0.0};
  newer.known.struct_size = sizeof newer;
  EXPECT_OK(sunder_scene_set_solver(scene, &newer.known));
}

TEST_F(CStructs, TakeOptionsOfACallerFromBeforePreparation) {
  sunder_solver_options older = on(SUNDER_BACKEND_CPU);
  older.struct_size = offsetof(sunder_solver_options, no_preparation);
  older.no_preparation = -1;  // not the caller's memory any more
  EXPECT_OK(sunder_scene_set_solver(scene, &older));
  older.struct_size -= 8;
  EXPECT_EQ(sunder_scene_set_solver(scene, &older), SUNDER_ERROR_STRUCT_SIZE);
}

/// Memory of a pulled board's solver, with the columns of predicted fractures if it prepared any.
std::uint64_t memory_after_a_step(std::int32_t no_preparation) {
  const sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, 4, -0.5);
  sunder_solver_options options = on(SUNDER_BACKEND_CPU);
  options.route = SUNDER_ROUTE_FACTOR;
  options.no_preparation = no_preparation;
  EXPECT_OK(sunder_scene_set_solver(scene, &options));
  sunder_simulation simulation = nullptr;
  EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  EXPECT_OK(sunder_simulation_step(simulation, nullptr));
  sunder_engine engine{};
  engine.struct_size = sizeof engine;
  EXPECT_OK(sunder_simulation_engine(simulation, &engine));
  EXPECT_OK(sunder_simulation_destroy(simulation));
  EXPECT_OK(sunder_scene_destroy(scene));
  return engine.memory_bytes;
}

TEST_F(CStructs, LeaveThePreparationOutWhenAsked) {
  EXPECT_GT(memory_after_a_step(0), memory_after_a_step(1));
}

TEST_F(CStructs, FillAStepOfACallerFromBeforeTheMeasures) {
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  sunder_step step{};
  step.struct_size = offsetof(sunder_step, strain_max);
  step.strain_max = 3;  // not the caller's memory any more
  ASSERT_OK(sunder_simulation_step(simulation, &step));
  EXPECT_GT(step.max_yield_ratio, 0);
  EXPECT_EQ(step.strain_max, 3);
  step.struct_size -= 8;
  EXPECT_EQ(sunder_simulation_step(simulation, &step), SUNDER_ERROR_STRUCT_SIZE);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST_F(CStructs, MayLieAnywhere) {
  const sunder_solver_options options = on(SUNDER_BACKEND_CPU);
  std::vector<char> bytes(sizeof options + 1);
  std::memcpy(bytes.data() + 1, &options, sizeof options);
  const void* unaligned = bytes.data() + 1;
  EXPECT_OK(sunder_scene_set_solver(scene, static_cast<const sunder_solver_options*>(unaligned)));
}

TEST_F(CStructs, HaveDefaultsOfTheirOwn) {
  sunder_fracture_options f;
  std::memset(&f, 0xff, sizeof f);
  sunder_fracture_options_init(&f);
  EXPECT_EQ(f.struct_size, sizeof f);
  EXPECT_EQ(f.model, SUNDER_FRACTURE_NONE);
  EXPECT_EQ(f.alpha, 1e-6);
  EXPECT_EQ(f.max_events, 10000);
  sunder_solver_options s;
  sunder_solver_options_init(&s);
  EXPECT_EQ(s.device, -1);
  EXPECT_EQ(s.tolerance, 1e-4);
  sunder_fracture_options_init(nullptr);
  sunder_solver_options_init(nullptr);
  sunder_material_init(nullptr);
  sunder_support_init(nullptr);
  sunder_instrument_init(nullptr);
  sunder_preset_crack_init(nullptr);
  sunder_fibres_init(nullptr);
  sunder_version(nullptr, nullptr, nullptr);
}

TEST_F(CStructs, CutTextsAndTellTheirLength) {
  sunder_plan plan = nullptr;
  ASSERT_OK(sunder_plan_create(scene, &plan));
  std::int32_t buffers = 0, left_out = 0;
  ASSERT_OK(sunder_plan_counts(plan, &buffers, &left_out));
  ASSERT_GT(buffers, 0);
  ASSERT_GT(left_out, 0);
  std::size_t length = 0;
  ASSERT_OK(sunder_plan_left_out(plan, 0, nullptr, 0, &length));
  ASSERT_GT(length, 4u);
  std::string text(length + 1, '?'), cut(5, '?');
  ASSERT_OK(sunder_plan_left_out(plan, 0, text.data(), text.size(), &length));
  ASSERT_OK(sunder_plan_left_out(plan, 0, cut.data(), cut.size(), nullptr));
  EXPECT_EQ(text.back(), '\0');
  EXPECT_EQ(cut, text.substr(0, 4) + '\0');
  std::uint64_t sum = 0;
  for (std::int32_t b = 0; b < buffers; ++b) {
    std::uint64_t bytes = 0;
    ASSERT_OK(sunder_plan_buffer(plan, b, &bytes, nullptr, 0, nullptr));
    sum += bytes;
  }
  sunder_engine engine{};
  engine.struct_size = sizeof engine;
  ASSERT_OK(sunder_plan_engine(plan, &engine));
  EXPECT_EQ(sum, engine.memory_bytes) << "the buffers are the memory that is predicted";
  EXPECT_OK(sunder_plan_destroy(plan));
}

TEST_F(CStructs, KeepErrorsByHandleAndByThread) {
  sunder_scene other = nullptr;
  ASSERT_OK(sunder_scene_create(&other));
  EXPECT_EQ(sunder_scene_set_steps(scene, -5), SUNDER_ERROR_VALUE);
  EXPECT_EQ(sunder_scene_set_steps(other, -6), SUNDER_ERROR_VALUE);
  char text[200];
  ASSERT_OK(sunder_error_of(scene, text, sizeof text, nullptr));
  EXPECT_STREQ(text, "steps = -5 is below 1");
  ASSERT_OK(sunder_error_of(other, text, sizeof text, nullptr));
  EXPECT_STREQ(text, "steps = -6 is below 1");
  EXPECT_STREQ(sunder_last_error(), "steps = -6 is below 1");
  EXPECT_OK(sunder_scene_destroy(other));
}

TEST_F(CStructs, StatusesHaveTexts) {
  for (sunder_status s = SUNDER_OK; s <= SUNDER_ERROR_CANCELLED; ++s) {
    EXPECT_STRNE(sunder_status_text(s), "unknown status") << s;
  }
  EXPECT_STREQ(sunder_status_text(-1), "unknown status");
  EXPECT_STREQ(sunder_status_text(999), "unknown status");
}

}  // namespace
}  // namespace sunder::test
