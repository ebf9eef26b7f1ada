// SPDX-License-Identifier: Apache-2.0
// Toughness, tissues by name and tips through the C interface.
#include <cmath>
#include <cstring>

#include "api/c_scene.hpp"
#include "sunder/tissue_presets.hpp"

namespace sunder::test {
namespace {

TEST(CPresets, AreThoseOfTheTable) {
  int32_t count = 0;
  EXPECT_OK(sunder_preset_count(&count));
  ASSERT_EQ(count, static_cast<int32_t>(tissue_presets().size()));
  for (int32_t i = 0; i < count; ++i) {
    char name[64] = "";
    size_t length = 0;
    EXPECT_OK(sunder_preset_at(i, name, sizeof name, &length));
    const TissuePreset& preset = tissue_presets()[static_cast<std::size_t>(i)];
    EXPECT_EQ(name, preset.name);
    EXPECT_EQ(length, preset.name.size());
    sunder_material material = SUNDER_MATERIAL_INIT;
    material.name = "organ";
    material.law = SUNDER_LAW_COROTATED;
    material.toughness = 7;  // of before
    EXPECT_OK(sunder_material_preset(name, &material));
    const Material of = preset.material();
    EXPECT_EQ(material.young, of.young);
    EXPECT_EQ(material.poisson, of.poisson);
    EXPECT_EQ(material.yield, of.yield.value_or(0));
    EXPECT_EQ(material.density, of.density.value_or(0));
    EXPECT_EQ(material.toughness, of.toughness.value_or(0));
    EXPECT_EQ(material.energy, of.energy.value_or(0));
    EXPECT_STREQ(material.name, "organ");
    EXPECT_EQ(material.law, SUNDER_LAW_COROTATED);
  }
}

// A caller compiled before toughness came gets what it has room for.
TEST(CPresets, FillAnOlderCallersMaterial) {
  sunder_material older = SUNDER_MATERIAL_INIT;
  older.struct_size = offsetof(sunder_material, toughness);
  older.toughness = -1;
  EXPECT_OK(sunder_material_preset("liver-porcine", &older));
  EXPECT_EQ(older.young, find_preset("liver-porcine")->young.value);
  EXPECT_EQ(older.toughness, -1);
}

TEST(CToughness, OlderMaterialsHaveNone) {
  sunder_scene scene = nullptr;
  EXPECT_OK(sunder_scene_create(&scene));
  sunder_material older = SUNDER_MATERIAL_INIT;
  older.struct_size = offsetof(sunder_material, toughness);
  older.young = 5;
  older.toughness = NAN;  // not the caller's memory any more
  EXPECT_OK(sunder_scene_add_material(scene, &older, nullptr));
  EXPECT_OK(sunder_scene_destroy(scene));
}

/// A board of 10 x 10 x 1 mm held at the top and pulled at its lower edge by `force`, with a crack
/// of a row of elements from the left to the middle; nothing yields.
sunder_simulation notched(double toughness, double force) {
  sunder_scene scene = nullptr;
  EXPECT_OK(sunder_scene_create(&scene));
  const Arrays a = board_arrays(10);
  EXPECT_OK(sunder_scene_set_mesh(scene, a.nodes.data(), a.nodes.size(), a.tets.data(),
                                  a.tets.size(), nullptr, 0));
  sunder_material tissue = SUNDER_MATERIAL_INIT;
  tissue.young = 5;
  tissue.poisson = 0.3;
  tissue.toughness = toughness;
  EXPECT_OK(sunder_scene_add_material(scene, &tissue, nullptr));
  const sunder_support support = top_support();
  EXPECT_OK(sunder_scene_add_support(scene, &support));
  sunder_instrument pull = corner_pull(force);
  pull.nodes = box(-1, -0.01, 11, 0.01);
  EXPECT_OK(sunder_scene_add_instrument(scene, &pull, nullptr));
  sunder_preset_crack crack = SUNDER_PRESET_CRACK_INIT;
  crack.has_mouth = 1;
  crack.elements = box(-1, 4, 5, 5);
  crack.mouth[1] = crack.tips[0][1] = 4.5;
  crack.tips[0][0] = 5;
  EXPECT_OK(sunder_scene_add_crack(scene, &crack));
  auto fracture = model(SUNDER_FRACTURE_B);
  fracture.sif = SUNDER_SIF_FIELD;
  fracture.max_events = 1;
  EXPECT_OK(sunder_scene_set_fracture(scene, &fracture));
  const auto solver = on(SUNDER_BACKEND_CPU);
  EXPECT_OK(sunder_scene_set_solver(scene, &solver));
  sunder_simulation simulation = nullptr;
  EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  EXPECT_OK(sunder_scene_destroy(scene));
  return simulation;
}

TEST(CTips, TellKAndKc) {
  const sunder_simulation simulation = notched(1e6, -1);
  int32_t count = -1;
  EXPECT_OK(sunder_simulation_measure_tips(simulation, &count));
  EXPECT_EQ(count, 0) << "nothing is solved yet";
  EXPECT_OK(sunder_simulation_step(simulation, nullptr));
  EXPECT_OK(sunder_simulation_measure_tips(simulation, &count));
  ASSERT_EQ(count, 1);
  sunder_tip tip = SUNDER_TIP_INIT;
  EXPECT_OK(sunder_simulation_tip_at(simulation, 0, &tip));
  EXPECT_EQ(tip.known, SUNDER_TIP_K | SUNDER_TIP_THETA | SUNDER_TIP_MODES | SUNDER_TIP_J |
                           SUNDER_TIP_TOUGHNESS);
  EXPECT_EQ(tip.toughness, 1e6);
  EXPECT_EQ(tip.plane_strain, 0) << "1 mm thick, ring of 6 h";
  EXPECT_EQ(tip.ended, 0);
  EXPECT_EQ(tip.position[0], 5);
  EXPECT_EQ(tip.position[2], 0.5);
  EXPECT_GT(tip.k, 0);
  EXPECT_GT(tip.k_1, 0);
  EXPECT_GT(tip.j, 0);
  EXPECT_STREQ(tip.field_note, "fixed") << "the ring reaches the held edge";
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST(CTips, GrowByKc) {
  const sunder_simulation simulation = notched(0.1, -20);
  EXPECT_OK(sunder_simulation_step(simulation, nullptr));
  int32_t count = 0;
  EXPECT_OK(sunder_simulation_event_count(simulation, &count));
  sunder_event event = SUNDER_EVENT_INIT;
  EXPECT_OK(sunder_simulation_event_at(simulation, count - 1, &event));
  EXPECT_EQ(event.cause, SUNDER_CAUSE_SIF);
  EXPECT_EQ(event.toughness, 0.1);
  EXPECT_NEAR(event.ratio, event.k / 0.1, 1e-9);
  EXPECT_GT(event.advance, 0.5);
  EXPECT_EQ(event.reach, 0);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

}  // namespace
}  // namespace sunder::test
