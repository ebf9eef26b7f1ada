// SPDX-License-Identifier: Apache-2.0
#include "app/input/input_support.hpp"
#include "app/input/scene_toml.hpp"

namespace sunder::test {
namespace {

using F = InputFault;

Scene with_overrides(const std::vector<std::string>& overrides) {
  return app::parse_scene(good_scene(), "bad.toml", overrides).scene;
}

TEST(Overrides, ReplaceAndAddAnyKey) {
  const Scene scene =
      with_overrides({"fracture.model=A", "instrument.0.force=[0,-50,0]", "time.steps=7",
                      "solver.tolerance=1e-5", "solver.prepare=false", "material.upper.yield=3",
                      "title=two words", "output.fields=[\"stress\"]", "fixed.0.axes=xy",
                      "instrument.0.force.1=-40", "solver.device=1"});
  EXPECT_EQ(scene.fracture.model, FractureModel::a);
  EXPECT_EQ(std::get<Pull>(scene.instruments[0].action).force, Vec3(0, -40, 0));
  EXPECT_EQ(scene.steps, 7);
  EXPECT_EQ(scene.solver.tolerance, 1e-5);
  EXPECT_FALSE(scene.solver.prepare);
  EXPECT_EQ(scene.materials.at("upper").yield, 3.0);
  EXPECT_EQ(scene.title, "two words");
  EXPECT_FALSE(scene.output.displacement);
  EXPECT_EQ(scene.supports[0].axes, Axes{3});
  EXPECT_EQ(scene.solver.device, 1);
}

TEST(Overrides, AddTablesAndQuotedNames) {
  const Scene scene = with_overrides({"material.\"a.b\".young=3", "material.\"a.b\".poisson=0.3",
                                      "fixed.1.nodes=[4]", "fixed.1.axes=z"});
  EXPECT_EQ(scene.materials.at("a.b").young, 3.0);
  ASSERT_EQ(scene.supports.size(), 2U);
  EXPECT_EQ(std::get<std::vector<Index>>(scene.supports[1].nodes), std::vector<Index>{4});
}

TEST(Overrides, MakeSectionsThatAreNotThere) {
  const Scene scene =
      app::parse_scene("mesh = \"m.msh\"", "s.toml",
                       {"fracture.model=B", "fixed.0.nodes=[1]", "fixed.1.nodes=[2]"})
          .scene;
  EXPECT_EQ(scene.fracture.model, FractureModel::b);
  EXPECT_EQ(scene.supports.size(), 2U);
}

TEST(Overrides, NameTheirTextWhenWrong) {
  const struct {
    std::string text;
    InputFault fault;
    std::vector<std::string> parts;
  } cases[] = {
      {"", F::syntax, {"key.path=value"}},
      {"fracture.model", F::syntax, {"key.path=value"}},
      {"=3", F::syntax, {"key.path=value"}},
      {"fracture..model=A", F::syntax, {"key.path=value"}},
      {".=3", F::syntax, {"key.path=value"}},
      {"\"open=3", F::syntax, {"key.path=value"}},
      {"time.steps=", F::syntax, {"the value is empty"}},
      {"instrument.0.force=[0,-50", F::syntax, {"not valid TOML"}},
      {"title=\"open", F::syntax, {"not valid TOML"}},
      {"fracture.modle=A", F::unknown_key, {"fracture.modle", "did you mean \"model\""}},
      {"fractur.model=A", F::unknown_key, {"\"fractur\"", "did you mean \"fracture\""}},
      {"fracture.model=C", F::unknown_key, {"\"none\", \"A\", \"B\" or \"P\""}},
      {"fracture.model.x=1", F::unknown_key, {"\"x\" lies inside a plain value"}},
      {"time.steps=many", F::wrong_type, {"time.steps takes an integer", "\"many\""}},
      {"time.steps=0", F::out_of_range, {"time.steps is 0"}},
      {"time.steps=1\nmesh=2", F::syntax, {R"(--set time.steps=1\nmesh=2)"}},
      {"solver.prepare=1", F::wrong_type, {"solver.prepare", "true or false"}},
      {"solver.tolerance=nan", F::out_of_range, {"solver.tolerance", "finite"}},
      {"instrument.9.force=[0,0,0]", F::bad_id, {"\"9\"", "0 to 3"}},
      {"instrument.x.force=[0,0,0]", F::bad_id, {"\"x\"", "0 to 3"}},
      {"instrument.99999999999999999999999.force=[0,0,0]", F::bad_id, {"0 to 3"}},
      {"instrument.0.force=[0,0]", F::wrong_type, {"3 numbers", "an array of 2"}},
      {"instrument=3", F::wrong_type, {"[[instrument]]", "the integer 3"}},
      {"fracture=A", F::wrong_type, {"[fracture]", "the string \"A\""}},
      {"instrument.3.name=third", F::missing_key, {"instrument.3.kind"}},
  };
  for (const auto& bad : cases) {
    SCOPED_TRACE(bad.text);
    std::vector<std::string> parts = bad.parts;
    // A missing key has no text of its own.
    const std::string shown = bad.text.substr(0, bad.text.find('\n'));
    if (bad.fault != F::missing_key) parts.push_back("--set " + shown);
    expect_input_error([&] { static_cast<void>(with_overrides({bad.text})); }, bad.fault, parts);
  }
}

}  // namespace
}  // namespace sunder::test
