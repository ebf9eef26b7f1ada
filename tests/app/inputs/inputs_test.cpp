// SPDX-License-Identifier: Apache-2.0
// The reader of inputs: each kind as it is written, and a sentence for each line that is wrong.
#include "app/inputs/inputs.hpp"

#include <gtest/gtest.h>

#include "core/frame/strip.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using namespace app;

Inputs parse(const std::string& text) { return parse_inputs(text, "in.txt"); }

template <class What>
What only(const std::string& text) {
  const Inputs inputs = parse(text);
  EXPECT_EQ(inputs.list.size(), 1U) << text;
  return std::get<What>(inputs.list.at(0).what);
}

TEST(Inputs, AreReadOneALineWithCommentsAndBlanks) {
  const Inputs inputs = parse("# all of it\n\n  step 3 # three\n\tframe\r\nundo");
  ASSERT_EQ(inputs.list.size(), 3U);
  EXPECT_EQ(inputs.list[0].line, 3);
  EXPECT_EQ(std::get<input::Step>(inputs.list[0].what).count, 3);
  EXPECT_EQ(inputs.list[1].line, 4);
  EXPECT_EQ(std::get<input::Frame>(inputs.list[1].what).count, 1);
  EXPECT_EQ(inputs.list[2].line, 5);
  EXPECT_TRUE(std::holds_alternative<input::Undo>(inputs.list[2].what));
  EXPECT_EQ(parse("").list.size(), 0U);
}

TEST(Inputs, OfTheBodyAreReadToTheBit) {
  const auto drive = only<input::Drive>("drive \"right forceps\" 0.1 -2e-3 +4");
  EXPECT_EQ(drive.instrument, "right forceps");
  EXPECT_EQ(drive.value, Vec3(0.1, -2e-3, 4));
  EXPECT_FALSE(drive.further);
  EXPECT_TRUE(only<input::Drive>("move hook 1 0 0").further);
  EXPECT_EQ(only<input::Turn>("turn hook 0 0 90").rotation, Vec3(0, 0, 90));
  EXPECT_EQ(only<input::Remove>("remove 4 2 9").elements, (std::vector<Index>{4, 2, 9}));
  EXPECT_EQ(only<input::Cut>("cut 0 0 0 0 0 1 1 0 0 1 0 1").edge.size(), 4U);
}

TEST(Inputs, OfTheViewAreRead) {
  const auto camera = only<input::Camera>("camera 30 -15 2");
  EXPECT_EQ(camera.azimuth, 30);
  EXPECT_EQ(camera.elevation, -15);
  EXPECT_EQ(camera.zoom, 2);
  EXPECT_EQ(only<input::Camera>("camera 30 -15").zoom, 1);
  EXPECT_EQ(only<input::Look>("look 1 2 3").at, Vec3(1, 2, 3));
  EXPECT_FALSE(only<input::Look>("look body").at);
  const auto colour = only<input::Colour>("colour yield 0.5");
  EXPECT_EQ(colour.field, Field::yield);
  EXPECT_EQ(colour.maximum, 0.5);
  EXPECT_FALSE(only<input::Colour>("colour strain auto").maximum);
  const auto clip = only<input::Clip>("clip 0 0 2 1.5");
  EXPECT_EQ(clip.normal, Vec3(0, 0, 1));
  EXPECT_EQ(clip.offset, 1.5);
  EXPECT_FALSE(only<input::Clip>("clip off").normal);
  EXPECT_TRUE(only<input::Show>("wireframe on").on);
  EXPECT_FALSE(only<input::Show>("record off").on);
  EXPECT_EQ(only<input::Show>("fibres off").what, input::Show::What::fibres);
  EXPECT_TRUE(only<input::Pause>("pause").on);
  EXPECT_FALSE(only<input::Pause>("go").on);
  EXPECT_EQ(only<input::Stroke>("stroke 0 .5 1 .5").line.size(), 2U);
}

TEST(Inputs, CountTheirFrames) {
  EXPECT_EQ(parse("frame 3\nstep 9\nframe").frames(), 4);
  EXPECT_EQ(parse("step").frames(), 0);
}

struct Bad {
  std::string text;
  std::vector<std::string> parts;  // of the message
};

void expect_refused(const Bad& bad, const std::function<void()>& act) {
  SCOPED_TRACE(bad.text);
  try {
    act();
    ADD_FAILURE() << "was taken";
  } catch (const InputError& error) {
    EXPECT_EQ(error.exit_code(), 3);
    for (const std::string& part : bad.parts) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << error.what() << "\nlacks " << part;
    }
  }
}

TEST(Inputs, ThatAreWrongAreRefusedWithTheirLine) {
  const std::vector<Bad> cases{
      {"step\nfly", {"in.txt:2: ", "\"fly\" is no input", "\"drive\"", "\"record\""}},
      {"stepp", {"in.txt:1: ", "perhaps \"step\" was meant"}},
      {"step 0", {"the number of steps is \"0\"", "a whole number from 1"}},
      {"step 1.5", {"\"1.5\"", "a whole number"}},
      {"step 2 3", {"from \"3\" on is too much"}},
      {"frame 99999999999", {"\"99999999999\""}},
      {"drive", {"the instrument's name is missing"}},
      {"drive hook 1 2", {"the value, z is missing"}},
      {"drive hook 1 x 3", {"the value, y is \"x\"", "a finite number"}},
      {"drive hook 1 nan 3", {"\"nan\"", "a finite number"}},
      {"drive hook 1 1e999 3", {"\"1e999\""}},
      {"drive \"hook 1 2 3", {"has no end"}},
      {"remove", {"an element to remove is missing"}},
      {"remove -1", {"\"-1\"", "from 0"}},
      {"cut 0 0 0 0 0 1 1 0 0", {"cut has 3 points", "two points for each place"}},
      {"cut 0 0 0 0 0 1", {"cut has 2 points"}},
      {"stroke 0 0", {"two points or more"}},
      {"stroke 0 0 1 1.5", {"leaves the picture"}},
      {"camera 1", {"the elevation [deg] is missing"}},
      {"camera 1 2 0", {"the zoom must be above 0"}},
      {"colour heat", {"the field is \"heat\"", "\"stress\", \"yield\", \"strain\""}},
      {"colour stress 0", {"must be above 0"}},
      {"clip 0 0 0 1", {"normal of the clipping plane is zero"}},
      {"wireframe maybe", {"\"maybe\"", "\"on\" or \"off\""}},
  };
  for (const Bad& bad : cases) {
    expect_refused(bad, [&] { static_cast<void>(parse(bad.text)); });
  }
}

TEST(Inputs, AreHeldAgainstTheScene) {
  const Problem problem(strip(0.6, 3, 8));
  const std::string name = problem.scene().instruments.at(0).name;
  const std::vector<Bad> cases{
      {"drive nobody 0 0 0", {"in.txt:1: ", "no instrument \"nobody\"", "it has"}},
      {"remove 999999", {"there is no element 999999", "the mesh has"}},
      {"turn \"" + name + "\" 0 0 9", {"cannot be turned"}},
  };
  for (const Bad& bad : cases) {
    expect_refused(bad, [&] {
      Inputs inputs = parse(bad.text);
      resolve(inputs, problem);
    });
  }
  Inputs by_number = parse("drive 0 1 2 3");
  EXPECT_NO_THROW(resolve(by_number, problem));
}

TEST(Inputs, WithoutYieldOrStressCannotColourByThem) {
  Scene scene = strip(0.6, 3, 8);
  for (auto& [name, material] : scene.materials) material.yield.reset();
  scene.fracture.model = FractureModel::none;
  scene.output.stress = false;
  const Problem problem(scene);
  for (const char* field : {"yield", "stress"}) {
    const Bad bad{std::string("colour ") + field, {"cannot be coloured by", field}};
    expect_refused(bad, [&] {
      Inputs inputs = parse(bad.text);
      resolve(inputs, problem);
    });
  }
  Inputs strain = parse("colour strain");
  EXPECT_NO_THROW(resolve(strain, problem));
}

TEST(Inputs, AreWrittenAsTheyAreRead) {
  input::Drive drive{"right forceps", {0.1, 1e-300, -3}, false, 2};
  const auto again = only<input::Drive>(text_of(drive));
  EXPECT_EQ(again.instrument, drive.instrument);
  EXPECT_EQ(again.value, drive.value);
  drive.instrument = "a \"b\"";  // no line can hold it: by its number
  EXPECT_EQ(only<input::Drive>(text_of(drive)).instrument, "2");
  EXPECT_EQ(only<input::Remove>(text_of(input::Remove{{7, 1}})).elements,
            (std::vector<Index>{7, 1}));
  EXPECT_EQ(only<input::Step>(text_of(input::Step{4})).count, 4);
}

}  // namespace
}  // namespace sunder::test
