// SPDX-License-Identifier: Apache-2.0
// Scenes that are wrong in one place each: the message names file, line and key, the value, and
// what is allowed.
#include "app/input/input_support.hpp"
#include "app/input/scene_toml.hpp"
#include "app/mesh_board/board.hpp"

namespace sunder::test {
namespace {

using F = InputFault;

struct SceneCase {
  std::string from, to;  // one edit of good_scene()
  InputFault fault;
  std::vector<std::string> parts;  // of the message
};

void expect_all(const std::vector<SceneCase>& cases,
                const std::function<void(const std::string&)>& read) {
  for (const SceneCase& bad : cases) {
    SCOPED_TRACE("\"" + bad.from + "\" -> \"" + bad.to + "\"");
    const std::string text = with(good_scene(), bad.from, bad.to);
    expect_input_error([&] { read(text); }, bad.fault, bad.parts);
  }
}

void read(const std::string& text) { static_cast<void>(app::parse_scene(text, "bad.toml")); }

TEST(BadScenes, TheBaseTextIsRight) { EXPECT_NO_THROW(read(good_scene())); }

TEST(BadScenes, NotToml) {
  expect_all(
      {
          {"title = \"A", "title = \"A\n", F::syntax, {"bad.toml:1:", "not valid TOML"}},
          {"mesh = \"board.msh\"", "mesh = board.msh", F::syntax, {"bad.toml:2:"}},
          {"[time]\nsteps", "[time\nsteps", F::syntax, {"bad.toml:"}},
          {"young = 5\n", "young = 5\nyoung = 6\n", F::syntax, {"bad.toml:13:", "young"}},
          {"[solver]", "[fracture]", F::syntax, {"bad.toml:65:", "fracture"}},
          {"alpha = 1e-6", "alpha = 1e-", F::syntax, {"bad.toml:57:"}},
          {"step = 3", "step = 99999999999999999999", F::syntax, {"bad.toml:52:"}},
          {"steps = 4", "steps = 4\u0262", F::syntax, {"bad.toml:73:", "not ASCII"}},
          {"title = \"A", std::string("title = \"\xff\xfe"), F::syntax, {"bad.toml:1:"}},
      },
      read);
}

TEST(BadScenes, Toughness) {
  expect_all(
      {
          {"young = 5\n",
           "young = 5\ntoughness = \"high\"\n",
           F::wrong_type,
           {"bad.toml:13:", "material.upper.toughness takes a number"}},
          {"young = 5\n",
           "young = 5\nenergy = nan\n",
           F::out_of_range,
           {"bad.toml:13:", "material.upper.energy", "finite"}},
          {"young = 5\n",
           "young = 5\ntoughnes = 1\n",
           F::unknown_key,
           {"bad.toml:13:", "\"toughness\""}},
      },
      read);
}

TEST(BadScenes, Presets) {
  expect_all(
      {
          {"young = 5\n",
           "preset = \"liver-porcin\"\n",
           F::unknown_key,
           {"bad.toml:12:",
            "material.upper.preset is \"liver-porcin\", perhaps \"liver-porcine\" was "
            "meant; allowed: \"aortic-media-axial\"",
            "or \"skin-porcine\""}},
          {"young = 5\n",
           "preset = \"granite\"\n",
           F::unknown_key,
           {"material.upper.preset is \"granite\"; allowed: "}},
          {"young = 5\n",
           "preset = 3\n",
           F::wrong_type,
           {"material.upper.preset takes a string, not the integer 3"}},
      },
      read);
}

// What a message quotes stays one line and cannot end it early.
TEST(BadScenes, NamesWithControlCharacters) {
  expect_all(
      {
          {"mesh = ", "\"\" = ", F::unknown_key, {"bad.toml:2:1", "unknown key \"\"", "\"mesh\""}},
          {"mesh = ",
           R"("a\nb\u0000c" = )",
           F::unknown_key,
           {"bad.toml:2:1", R"(unknown key "a\nb\u0000c";)", "\"fracture\""}},
          {"mesh = ",
           std::string(300, 'n') + " = ",
           F::unknown_key,
           {"unknown key \"nnn", "nnn...\"; allowed"}},
          {"young = 5\n", "\"\" = 5\n", F::unknown_key, {"unknown key material.upper.\"\";"}},
          {"[material.upper]\nyoung = 5\n",
           "[material.\"\\n\\u001b[1m\"]\nyoung = \"5\"\n",
           F::wrong_type,
           {"bad.toml:12:9", R"(material."\n\u001b[1m".young takes a number)"}},
          {"[material.upper]\n",
           "[material]\n\"\\u0000\" = 3\n[material.upper]\n",
           F::wrong_type,
           {"bad.toml:12:12", R"(material."\u0000" takes a table)"}},
          {"side = \"upper\"",
           R"(side = "up\nper\u007f")",
           F::unknown_key,
           {R"("up\nper\u007f"; allowed: "upper" or "lower")"}},
          {"axes = \"xyz\"", R"(axes = "x\ty")", F::unknown_key, {R"(axes is "x\ty"; allowed)"}},
          {"\"stress\"]", R"("\r\u0085"])", F::unknown_key, {R"(contains "\r\u0085"; allowed)"}},
          {"poisson = 0.4", "poisson = n\n", F::syntax, {"bad.toml:6:", R"(saw 'n\n)"}},
      },
      read);
}

TEST(BadScenes, UnknownKeys) {
  expect_all(
      {
          {"mesh = ",
           "msh = ",
           F::unknown_key,
           {"bad.toml:2:1", "unknown key \"msh\"", "did you mean \"mesh\"", "\"fracture\""}},
          {"young = 5\n",
           "youngs = 5\n",
           F::unknown_key,
           {"bad.toml:12:1", "\"material.upper.youngs\"", "did you mean \"young\"", "\"poisson\""}},
          {"axes = \"xyz\"",
           "axis = \"xyz\"",
           F::unknown_key,
           {"bad.toml:21:1", "fixed.0.axis", "\"axes\""}},
          {"ramp = ",
           "rampe = ",
           F::unknown_key,
           {"bad.toml:28:1", "instrument.0.rampe", "\"ramp\""}},
          {"mouth = ", "mount = ", F::unknown_key, {"bad.toml:", "crack.0.mount", "\"mouth\""}},
          {"step = 3", "stage = 3", F::unknown_key, {"destroy.0.stage", "\"step\", \"volume\""}},
          {"sigma0 = ",
           "sigma_0 = ",
           F::unknown_key,
           {"fracture.sigma_0", "did you mean \"sigma0\""}},
          {"tolerance = ", "tol = ", F::unknown_key, {"solver.tol", "\"tolerance\""}},
          {"steps = 4", "dt = 4", F::unknown_key, {"time.dt", "\"steps\""}},
          {"fields = ", "field = ", F::unknown_key, {"output.field", "did you mean \"fields\""}},
          {"[output]", "[results]", F::unknown_key, {"unknown key \"results\"", "\"output\""}},
          {"side = \"upper\"\n",
           "side = \"upper\"\nbox = [[0,0,0],[1,1,1]]\n",
           F::unknown_key,
           {"instrument.2.box", "pressure", "\"at\""}},
          {"ramp = [0.0, 1.0]",
           "at = [0.0, 1.0, 2.0]",
           F::unknown_key,
           {"bad.toml:28:6", "instrument.0.at", "pressure"}},
          {"ramp = [0.0, 1.0]",
           "axes = \"y\"",
           F::unknown_key,
           {"instrument.0.axes", "\"displacement\" only"}},
          {"crack = 0",
           "displacement = [0, 1, 0]",
           F::unknown_key,
           {"instrument.2.displacement", "pressure takes a force"}},
          {"radius = 0.5",
           "radius = 0.5\nnodes = [1]",
           F::unknown_key,
           {"instrument.1", "\"nodes\"", "\"near\"", "exactly one of"}},
          {"axes = \"xyz\"", "radius = 1.0", F::unknown_key, {"fixed.0.radius", "\"near\" only"}},
          {"displacement = [0.0, -1.0, 0.0]",
           "displacement = [0, -1, 0]\nforce = [0, 1, 0]",
           F::unknown_key,
           {"instrument.1", "\"force\" and \"displacement\"", "exactly one of"}},
          {"tip = [46.0, 25.0, 1.0]",
           "tips = [[46, 25, 1], [44, 25, 1]]",
           F::unknown_key,
           {"crack.0.mouth", "internal crack has no mouth"}},
      },
      read);
}

TEST(BadScenes, MissingKeys) {
  expect_all(
      {
          {"mesh = \"board.msh\"\n", "", F::missing_key, {"bad.toml", "\"mesh\" is missing"}},
          {"young = 5\n",
           "",
           F::missing_key,
           {"bad.toml:11:1", "\"material.upper.young\" is missing"}},
          {"poisson = 0.4\nyield = 2.0\n", "", F::missing_key, {"material.upper.poisson"}},
          {"box = [[-1.0, 49.999, -1.0], [51.0, 50.001, 3.0]]\n",
           "",
           F::missing_key,
           {"bad.toml:19:1", "fixed.0", "\"box\", \"nodes\", \"near\" or \"surface\""}},
          {"kind = \"expansion\"\n", "", F::missing_key, {"bad.toml:23:1", "instrument.0.kind"}},
          {"force = [0.0, -60.0, 0.0]\n",
           "",
           F::missing_key,
           {"instrument.0", "\"force\" or \"displacement\""}},
          {"radius = 0.5\n", "", F::missing_key, {"instrument.1.radius"}},
          {"at = [48.0, 25.0, 1.0]\n", "", F::missing_key, {"instrument.2.at"}},
          {"side = \"upper\"\n", "", F::missing_key, {"instrument.2.side"}},
          {"force = [0.0, 5.0, 0.0]\n", "", F::missing_key, {"instrument.2.force"}},
          {"elements = [60, 61]\n", "", F::missing_key, {"crack.0", "\"volume\" or \"elements\""}},
          {"mouth = [50.0, 25.0, 1.0]\n", "", F::missing_key, {"crack.0.mouth"}},
          {"tip = [46.0, 25.0, 1.0]\n", "", F::missing_key, {"crack.0", "\"tip\" or \"tips\""}},
          {"step = 3\n", "", F::missing_key, {"destroy.0.step"}},
          {"elements = [1, 2]\n",
           "",
           F::missing_key,
           {"destroy.0", "\"volume\", \"elements\" or \"box\""}},
      },
      read);
}

TEST(BadScenes, WrongTypesAndLengths) {
  expect_all(
      {
          {"title = \"A scene that is right\"",
           "title = 7",
           F::wrong_type,
           {"bad.toml:1:9", "title takes a string", "the integer 7"}},
          {"mesh = \"board.msh\"",
           "mesh = [\"board.msh\"]",
           F::wrong_type,
           {"bad.toml:2:8", "mesh takes a string", "an array of 1"}},
          {"young = 5\n",
           "young = \"5\"\n",
           F::wrong_type,
           {"bad.toml:12:9", "material.upper.young takes a number", "the string \"5\""}},
          {"poisson = 0.4\nyield = 2.0",
           "poisson = true\nyield = 2.0",
           F::wrong_type,
           {"material.upper.poisson", "the boolean true"}},
          {"[material.upper]\nyoung = 5\npoisson = 0.4\nyield = 2.0",
           "[material]\nupper = 5",
           F::wrong_type,
           {"material.upper", "table", "the integer 5"}},
          {"force = [0.0, -60.0, 0.0]",
           "force = [0.0, -60.0]",
           F::wrong_type,
           {"bad.toml:27:9", "instrument.0.force takes 3 numbers [x, y, z]", "an array of 2"}},
          {"force = [0.0, -60.0, 0.0]",
           "force = -60.0",
           F::wrong_type,
           {"instrument.0.force", "the number -60"}},
          {"force = [0.0, -60.0, 0.0]",
           "force = [0.0, \"-60\", 0.0]",
           F::wrong_type,
           {"bad.toml:27:15", "the string \"-60\""}},
          {"box = [[49.999, -0.001, -1.0], [50.001, 0.001, 3.0]]",
           "box = [[0, 0, 0]]",
           F::wrong_type,
           {"instrument.0.box", "2 points", "an array of 1"}},
          {"box = [[49.999, -0.001, -1.0], [50.001, 0.001, 3.0]]",
           "box = [[0, 0], [1, 1]]",
           F::wrong_type,
           {"instrument.0.box", "an array of 2"}},
          {"box = [[49.999, -0.001, -1.0], [50.001, 0.001, 3.0]]",
           "box = 3",
           F::wrong_type,
           {"instrument.0.box", "the integer 3"}},
          {"ramp = [0.0, 1.0]",
           "ramp = [0.0, 1.0, 2.0]",
           F::wrong_type,
           {"instrument.0.ramp takes an array of 2 numbers", "an array of 3"}},
          {"ramp = [0.0, 1.0]", "ramp = 1979-05-27", F::wrong_type, {"a date or time"}},
          {"axes = \"xyz\"", "axes = [\"x\"]", F::wrong_type, {"fixed.0.axes takes a string"}},
          {"elements = [60, 61]",
           "elements = [60, 61.5]",
           F::wrong_type,
           {"crack.0.elements", "ids (integers)", "the number 61.5"}},
          {"elements = [60, 61]",
           "elements = 60",
           F::wrong_type,
           {"array of ids", "the integer 60"}},
          {"crack = 0", "crack = 0.0", F::wrong_type, {"instrument.2.crack takes an integer"}},
          {"[[crack]]", "[crack]", F::wrong_type, {"bad.toml:46:1", "[[crack]]", "a table"}},
          {"[fracture]", "[[fracture]]", F::wrong_type, {"[fracture]", "an array of 1"}},
          {"steps = 4", "steps = 4.0", F::wrong_type, {"time.steps takes an integer"}},
          {"fields = [\"displacement\", \"stress\"]",
           "fields = \"stress\"",
           F::wrong_type,
           {"output.fields", "array of strings"}},
          {"fields = [\"displacement\", \"stress\"]",
           "fields = [1]",
           F::wrong_type,
           {"output.fields", "the integer 1"}},
          {"plane_normal = [0, 0, 1]",
           "plane_normal = {x = 1}",
           F::wrong_type,
           {"fracture.plane_normal", "a table"}},
      },
      read);
}

TEST(BadScenes, ValuesThatAreNotAllowed) {
  expect_all(
      {
          {"young = 5\n",
           "young = nan\n",
           F::out_of_range,
           {"bad.toml:12:9", "material.upper.young", "not a number", "finite"}},
          {"alpha = 1e-6", "alpha = -inf", F::out_of_range, {"fracture.alpha", "-inf", "finite"}},
          {"force = [0.0, -60.0, 0.0]",
           "force = [0.0, inf, 0.0]",
           F::out_of_range,
           {"bad.toml:27:15", "inf", "finite"}},
          {"radius = 0.5", "radius = -0.5", F::out_of_range, {"instrument.1.radius"}},
          {"box = [[-1.0, 49.999, -1.0], [51.0",
           "box = [[-1.0, 49.999, -1.0], [-51.0",
           F::out_of_range,
           {"fixed.0.box", "along x", "min <= max"}},
          {"elements = [60, 61]", "elements = [-1]", F::bad_id, {"bad.toml:47:13", "the id -1"}},
          {"elements = [60, 61]", "elements = [4000000000]", F::bad_id, {"4000000000"}},
          {"crack = 0", "crack = -1", F::out_of_range, {"instrument.2.crack is -1", "0 to"}},
          {"step = 3", "step = -3", F::out_of_range, {"destroy.0.step is -3", "0 to"}},
          {"steps = 4", "steps = 0", F::out_of_range, {"time.steps is 0", "1 to"}},
          {"max_events = 10000", "max_events = 0", F::out_of_range, {"fracture.max_events is 0"}},
          {"alpha = 1e-6",
           "max_new_nodes = -1",
           F::out_of_range,
           {"fracture.max_new_nodes is -1", "0 to"}},
          {"alpha = 1e-6",
           "crack = \"slit\"",
           F::unknown_key,
           {"fracture.crack is \"slit\"", "\"destroyed\" or \"split\""}},
          {"alpha = 1e-6", "contact = 1", F::wrong_type, {"fracture.contact"}},
          {"steps = 4", "steps = 99999999999", F::out_of_range, {"time.steps is 99999999999"}},
          {"mesh = \"board.msh\"", "mesh = \"\"", F::out_of_range, {"bad.toml:2:8", "empty"}},
          {"kind = \"expansion\"",
           "kind = \"pull\"",
           F::unknown_key,
           {"bad.toml:25:8", "instrument.0.kind is \"pull\"", "\"expansion\" or \"pressure\""}},
          {"side = \"upper\"", "side = \"left\"", F::unknown_key, {"\"upper\" or \"lower\""}},
          {"axes = \"xyz\"",
           "axes = \"xw\"",
           F::unknown_key,
           {"bad.toml:21:8", "\"xw\"", "x, y, z"}},
          {"axes = \"xyz\"", "axes = \"\"", F::unknown_key, {"fixed.0.axes", "x, y, z"}},
          {"axes = \"xyz\"", "axes = \"xx\"", F::unknown_key, {"fixed.0.axes", "each once"}},
          {"model = \"B\"",
           "model = \"C\"",
           F::unknown_key,
           {"fracture.model is \"C\"", "\"none\", \"A\", \"B\" or \"P\""}},
          {"yield_measure = \"max_shear\"",
           "yield_measure = \"mises\"",
           F::unknown_key,
           {"\"max_shear\" or \"tresca\""}},
          {"sigma0 = \"line\"",
           "sigma0 = \"mean\"",
           F::unknown_key,
           {"\"line\", \"tip\" or \"present\""}},
          {"crack_length = \"path\"",
           "crack_length = \"a\"",
           F::unknown_key,
           {"\"path\" or \"tool\""}},
          {"sif = \"formula\"",
           "sif = \"guess\"",
           F::unknown_key,
           {"\"guess\"", "\"formula\" or \"field\""}},
          {"route = \"auto\"",
           "route = \"fast\"",
           F::unknown_key,
           {"\"auto\", \"inverse\", \"condensed\", \"factor\" or \"cg\""}},
          {"update = \"auto\"",
           "update = \"lazy\"",
           F::unknown_key,
           {"\"auto\", \"eager\" or \"deferred\""}},
          {"precision = \"auto\"",
           "precision = \"fp16\"",
           F::unknown_key,
           {"\"auto\", \"fp32\" or \"fp64\""}},
          {"\"stress\"]",
           "\"strain\"]",
           F::unknown_key,
           {"output.fields", "\"strain\"", "\"displacement\" and \"stress\""}},
      },
      read);
}

// What only a mesh can tell, with the place in the scene's file in front.
TEST(BadScenes, WhatTheMeshContradicts) {
  const TemporaryFolder folder;
  app::BoardOptions board;
  board.tets = 500;
  static_cast<void>(app::write_board(board, folder.file("board.msh")));
  const auto read = [&](const std::string& text) {
    static_cast<void>(app::read_problem(folder.write("bad.toml", text)));
  };
  EXPECT_NO_THROW(read(good_scene()));
  expect_all(
      {
          {"[material.upper]",
           "[material.uper]",
           F::unknown_name,
           {"bad.toml:11:1", "material \"uper\"", "upper"}},
          {"[material.top-frame]\nyoung = 500.0\npoisson = 0.4\n",
           "",
           F::no_material,
           {"bad.toml", "\"top-frame\""}},
          {"young = 5\n",
           "young = 0\n",
           F::out_of_range,
           {"bad.toml:11:1", "\"upper\"", "young = 0"}},
          {"young = 5\n", "young = -5\n", F::out_of_range, {"bad.toml:11:1", "young = -5"}},
          {"poisson = 0.4\nyield = 2.0",
           "poisson = 0.5\nyield = 2.0",
           F::out_of_range,
           {"bad.toml:11:1", "poisson = 0.5"}},
          {"poisson = 0.4\nyield = 2.0",
           "poisson = -1\nyield = 2.0",
           F::out_of_range,
           {"poisson = -1"}},
          {"yield = 2.0", "yield = 0", F::out_of_range, {"bad.toml:11:1", "yield = 0"}},
          {"alpha = 1e-6", "alpha = 0", F::out_of_range, {"bad.toml:57:9", "fracture.alpha"}},
          {"alpha = 1e-6", "alpha = 1", F::out_of_range, {"bad.toml:57:9", "fracture.alpha"}},
          {"tolerance = 1e-4", "tolerance = 0", F::out_of_range, {"bad.toml:70:13", "tolerance"}},
          {"ramp = [0.0, 1.0]",
           "ramp = [1.0, 0.0]",
           F::out_of_range,
           {"bad.toml:23:1", "\"right forceps\"", "ramp"}},
          {"plane_normal = [0, 0, 1]",
           "plane_normal = [0, 0, 0]",
           F::out_of_range,
           {"plane_normal"}},
          {"box = [[-1.0, 49.999, -1.0], [51.0, 50.001, 3.0]]",
           "surface = \"lid\"",
           F::unknown_name,
           {"bad.toml:19:1", "fixed 0", "\"lid\""}},
          {"box = [[-1.0, 49.999, -1.0], [51.0, 50.001, 3.0]]",
           "nodes = [9999]",
           F::bad_id,
           {"bad.toml:19:1", "fixed 0", "9999"}},
          {"box = [[-1.0, 49.999, -1.0], [51.0, 50.001, 3.0]]",
           "box = [[60.0, 60.0, 60.0], [61.0, 61.0, 61.0]]",
           F::empty_selection,
           {"bad.toml:19:1", "fixed 0"}},
          {"elements = [60, 61]",
           "elements = [60, 500]",
           F::bad_id,
           {"bad.toml:46:1", "crack 0", "500"}},
          {"elements = [60, 61]",
           "volume = \"notch\"",
           F::unknown_name,
           {"bad.toml:46:1", "crack 0", "\"notch\"", "upper"}},
          {"step = 3", "step = 4", F::out_of_range, {"bad.toml:51:1", "destroy 0", "step 4"}},
          {"model = \"B\"",
           "model = \"A\"",
           F::unknown_name,
           {"bad.toml:38:1", "\"probe\"", "model \"A\""}},
          {"name = \"left forceps\"",
           "name = \"right forceps\"",
           F::duplicate_name,
           {"bad.toml:23:1", "\"right forceps\"", "twice"}},
          {"axes = \"xyz\"", "axes = \"x\"", F::unsupported_body, {"bad.toml", "not held"}},
          {"mesh = \"board.msh\"",
           "mesh = \"nowhere.msh\"",
           F::unreadable_file,
           {"nowhere.msh", "no such file"}},
          {"mesh = \"board.msh\"",
           "mesh = \"bad.toml\"",
           F::unreadable_file,
           {"bad.toml", "extension \".toml\"", "\".msh\""}},
      },
      read);
}

TEST(BadScenes, FilesThatAreNone) {
  const TemporaryFolder folder;
  const auto read = [](const std::filesystem::path& path) {
    return [path] { static_cast<void>(app::read_scene(path)); };
  };
  expect_input_error(read(folder.file("none.toml")), F::unreadable_file,
                     {"none.toml", "no such file"});
  expect_input_error(read(folder.file("")), F::unreadable_file, {"is a directory"});
  expect_input_error(read(folder.write("empty.toml", "")), F::unreadable_file,
                     {"empty.toml", "empty"});
  expect_input_error(read("/dev/null"), F::unreadable_file, {"/dev/null", "regular file"});
  expect_input_error(read(folder.write("blank.toml", "\n")), F::missing_key,
                     {"blank.toml", "\"mesh\""});
  expect_input_error(read(folder.write("zeros.toml", std::string(100, '\0'))), F::syntax,
                     {"zeros.toml:1:1"});
  expect_input_error(read(std::filesystem::path(std::string(300, 'a'))), F::unreadable_file, {});
}

}  // namespace
}  // namespace sunder::test
