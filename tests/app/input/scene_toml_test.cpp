// SPDX-License-Identifier: Apache-2.0
#include "app/input/scene_toml.hpp"

#include "app/input/input_support.hpp"
#include "app/input/parsed_scene.hpp"
#include "sunder/tissue_presets.hpp"

namespace sunder::test {
namespace {

TEST(SceneToml, ReadsEveryKey) {
  const app::ParsedScene parsed = app::parse_scene(good_scene(), "scene.toml");
  const Scene& scene = parsed.scene;
  EXPECT_EQ(scene.title, "A scene that is right");
  EXPECT_EQ(scene.source, "scene.toml");
  EXPECT_EQ(parsed.mesh_path, "board.msh");

  ASSERT_EQ(scene.materials.size(), 4U);
  EXPECT_EQ(scene.materials.at("upper").young, 5.0);
  EXPECT_EQ(scene.materials.at("upper").poisson, 0.4);
  EXPECT_EQ(scene.materials.at("lower").yield, 4.0);
  EXPECT_FALSE(scene.materials.at("top-frame").yield.has_value());

  ASSERT_EQ(scene.supports.size(), 1U);
  EXPECT_EQ(scene.supports[0].axes, Axes{7});
  EXPECT_EQ(std::get<Box>(scene.supports[0].nodes).max, Vec3(51.0, 50.001, 3.0));

  ASSERT_EQ(scene.instruments.size(), 3U);
  EXPECT_EQ(scene.instruments[0].name, "right forceps");
  EXPECT_EQ(std::get<Pull>(scene.instruments[0].action).force, Vec3(0, -60, 0));
  ASSERT_TRUE(scene.instruments[0].ramp.has_value());
  EXPECT_EQ(scene.instruments[0].ramp->end, 1.0);
  const auto& grip = std::get<Grip>(scene.instruments[1].action);
  EXPECT_EQ(grip.displacement, Vec3(0, -1, 0));
  EXPECT_EQ(grip.axes, Axes{2});
  EXPECT_EQ(std::get<Ball>(grip.nodes).radius, 0.5);
  EXPECT_FALSE(scene.instruments[1].ramp.has_value());
  const auto& press = std::get<Press>(scene.instruments[2].action);
  EXPECT_EQ(press.at, Vec3(48, 25, 1));
  EXPECT_EQ(press.side, CrackSide::upper);
  EXPECT_EQ(press.force, Vec3(0, 5, 0));

  ASSERT_EQ(scene.cracks.size(), 1U);
  EXPECT_EQ(std::get<std::vector<Index>>(scene.cracks[0].elements), (std::vector<Index>{60, 61}));
  EXPECT_EQ(scene.cracks[0].mouth, Vec3(50, 25, 1));
  ASSERT_EQ(scene.cracks[0].tips.size(), 1U);
  ASSERT_EQ(scene.removals.size(), 1U);
  EXPECT_EQ(scene.removals[0].step, 3);

  EXPECT_EQ(scene.fracture.model, FractureModel::b);
  EXPECT_EQ(scene.fracture.plane_normal, Vec3(0, 0, 1));
  EXPECT_EQ(scene.steps, 4);
  EXPECT_TRUE(scene.output.stress);
}

TEST(SceneToml, ReadsToughness) {
  const std::string base = "mesh = \"m\"\n[material.a]\nyoung = 5\npoisson = 0.4\n";
  const auto material = [&](const std::string& more) {
    return parse(base + more).materials.at("a");
  };
  EXPECT_FALSE(material("").tough());
  EXPECT_EQ(material("toughness = 1.5").toughness, 1.5);
  EXPECT_FALSE(material("toughness = 1.5").energy);
  EXPECT_EQ(material("energy = 0.1").energy, 0.1);
}

TEST(SceneToml, APresetIsItsTissueAndKeysBesideItOverride) {
  const auto material = [](const std::string& more) {
    return parse("mesh = \"m\"\n[material.a]\npreset = \"liver-porcine\"\n" + more)
        .materials.at("a");
  };
  const Material liver = find_preset("liver-porcine")->material();
  ASSERT_TRUE(liver.energy);
  const Material plain = material("");
  EXPECT_EQ(plain.young, liver.young);
  EXPECT_EQ(plain.poisson, liver.poisson);
  EXPECT_EQ(plain.yield, liver.yield);
  EXPECT_EQ(plain.energy, liver.energy);
  EXPECT_EQ(plain.density, liver.density);
  EXPECT_EQ(plain.law, MaterialLaw::linear);
  const Material other = material("young = 0.02\nlaw = \"corotated\"");
  EXPECT_EQ(other.young, 0.02);
  EXPECT_EQ(other.yield, liver.yield);
  EXPECT_EQ(other.law, MaterialLaw::corotated);
  // Either of the two that say the same takes the place of the tissue's.
  const Material tough = material("toughness = 3");
  EXPECT_EQ(tough.toughness, 3.0);
  EXPECT_FALSE(tough.energy);
  EXPECT_EQ(material("energy = 3").energy, 3.0);
}

TEST(SceneToml, EveryPresetIsAMaterial) {
  for (const TissuePreset& preset : tissue_presets()) {
    const Scene scene =
        parse("mesh = \"m\"\n[material.a]\npreset = \"" + std::string(preset.name) + "\"\n");
    EXPECT_EQ(scene.materials.at("a").young, preset.young.value) << preset.name;
  }
}

TEST(SceneToml, ReadsHowCracksSplit) {
  const Scene scene =
      parse(with(good_scene(), "alpha = 1e-6", "crack = \"split\"\ncontact = true\nmax_new_nodes = 77"));
  EXPECT_EQ(scene.fracture.crack, CrackWay::split);
  EXPECT_TRUE(scene.fracture.contact);
  EXPECT_EQ(scene.fracture.max_new_nodes, 77);
}

TEST(SceneToml, DefaultsAreTheContracts) {
  const Scene scene = parse("mesh = \"m.msh\"");
  EXPECT_EQ(scene.title, "scene");
  EXPECT_EQ(scene.steps, 1);
  EXPECT_EQ(scene.fracture.model, FractureModel::none);
  EXPECT_EQ(scene.fracture.alpha, 1e-6);
  EXPECT_EQ(scene.fracture.yield_measure, YieldMeasure::max_shear);
  EXPECT_EQ(scene.fracture.sigma0, RemoteStress::line);
  EXPECT_EQ(scene.fracture.crack_length, CrackLength::path);
  EXPECT_EQ(scene.fracture.sif, SifSource::formula);
  EXPECT_EQ(scene.fracture.max_events, 10000);
  EXPECT_EQ(scene.fracture.crack, CrackWay::destroyed);
  EXPECT_EQ(scene.fracture.max_new_nodes, 0);
  EXPECT_FALSE(scene.fracture.contact);
  EXPECT_FALSE(scene.fracture.plane_normal.has_value());
  EXPECT_EQ(scene.solver.backend, "auto");
  EXPECT_EQ(scene.solver.device, kNone);
  EXPECT_EQ(scene.solver.route, Route::automatic);
  EXPECT_EQ(scene.solver.update, Update::automatic);
  EXPECT_EQ(scene.solver.precision, Precision::automatic);
  EXPECT_EQ(scene.solver.tolerance, 1e-4);
  EXPECT_TRUE(scene.output.displacement);
  EXPECT_TRUE(scene.output.stress);
}

TEST(SceneToml, RemoteStressOfThePresentField) {
  const Scene scene = parse(with(good_scene(), "\"line\"", "\"present\""));
  EXPECT_EQ(scene.fracture.sigma0, RemoteStress::present);
}

TEST(SceneToml, OtherWordsOfTheSchema) {
  std::string text = good_scene();
  text = with(text, "model = \"B\"", "model = \"A\"");
  text = with(text, "\"max_shear\"", "\"tresca\"");
  text = with(text, "\"line\"", "\"tip\"");
  text = with(text, "\"path\"", "\"tool\"");
  text = with(text, "route = \"auto\"", "route = \"cg\"");
  text = with(text, "update = \"auto\"", "update = \"eager\"");
  text = with(text, "precision = \"auto\"", "precision = \"fp64\"");
  text = with(text, "side = \"upper\"", "side = \"lower\"");
  text = with(text, "mouth = [50.0, 25.0, 1.0]\ntip = [46.0, 25.0, 1.0]",
              "tips = [[20, 25, 1], [30, 25, 1]]");
  text = with(text, "elements = [60, 61]", "volume = \"slit\"");
  text = with(text, "elements = [1, 2]", "box = [[0, 0, 0], [1, 1, 1]]");
  text = with(text, "box = [[-1.0, 49.999, -1.0], [51.0, 50.001, 3.0]]", "surface = \"top\"");
  text = with(text, "fields = [\"displacement\", \"stress\"]", "fields = []");
  const Scene scene = parse(text);
  EXPECT_EQ(scene.fracture.model, FractureModel::a);
  EXPECT_EQ(scene.fracture.yield_measure, YieldMeasure::tresca);
  EXPECT_EQ(scene.fracture.sigma0, RemoteStress::tip);
  EXPECT_EQ(scene.fracture.crack_length, CrackLength::tool);
  EXPECT_EQ(scene.solver.route, Route::cg);
  EXPECT_EQ(scene.solver.update, Update::eager);
  EXPECT_EQ(scene.solver.precision, Precision::fp64);
  EXPECT_EQ(std::get<Press>(scene.instruments[2].action).side, CrackSide::lower);
  EXPECT_FALSE(scene.cracks[0].mouth.has_value());
  EXPECT_EQ(scene.cracks[0].tips[1], Vec3(30, 25, 1));
  EXPECT_EQ(std::get<VolumeName>(scene.cracks[0].elements).name, "slit");
  EXPECT_TRUE(std::holds_alternative<Box>(scene.removals[0].elements));
  EXPECT_EQ(std::get<SurfaceName>(scene.supports[0].nodes).name, "top");
  EXPECT_FALSE(scene.output.stress);
  EXPECT_FALSE(scene.output.displacement);
}

TEST(SceneToml, SifFromTheField) {
  const Scene scene = parse(with(good_scene(), "sif = \"formula\"", "sif = \"field\""));
  EXPECT_EQ(scene.fracture.sif, SifSource::field);
}

}  // namespace
}  // namespace sunder::test
