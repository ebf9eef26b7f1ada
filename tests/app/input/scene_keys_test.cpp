// SPDX-License-Identifier: Apache-2.0
// The table of scene keys against the reader, row by row, and what is written from it.
#include "sunder/scene_keys.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "app/input/input_support.hpp"
#include "app/input/nearest.hpp"
#include "app/input/parsed_scene.hpp"
#include "app/input/scene_key_pages.hpp"
#include "app/input/scene_toml.hpp"
#include "sunder/tissue_presets.hpp"

namespace sunder::test {
namespace {

using Lines = std::vector<std::pair<std::string, std::string>>;  // key, value

/// What must stand beside a key so that it is the only thing wrong.
Lines company(const std::string& table, const std::string& key) {
  const Lines expansion{{"kind", "\"expansion\""}, {"force", "[0, 0, 1]"}};
  const Lines press{
      {"kind", "\"pressure\""}, {"at", "[0, 0, 0]"}, {"side", "\"upper\""}, {"force", "[0, 0, 1]"}};
  const std::map<std::string, Lines> special{
      {"fixed.radius", {{"near", "[0, 0, 0]"}}},
      {"fixed.axes", {{"nodes", "[0]"}}},
      {"instrument.at", press},
      {"instrument.side", press},
      {"instrument.crack", press},
      {"instrument.displacement", {{"kind", "\"expansion\""}, {"nodes", "[0]"}}},
      {"instrument.axes",
       {{"kind", "\"expansion\""}, {"displacement", "[0, 0, 1]"}, {"nodes", "[0]"}}},
      {"instrument.radius", {expansion[0], expansion[1], {"near", "[0, 0, 0]"}}},
      {"crack.volume", {{"tips", "[[0, 0, 0], [1, 0, 0]]"}}},
      {"crack.tips", {{"elements", "[0]"}}},
      {"destroy.step", {{"elements", "[0]"}}},
  };
  if (const auto found = special.find(table + '.' + key); found != special.end())
    return found->second;
  if (table == "fibres") {
    if (key == "direction" || key == "around" || key == "curve" || key == "field") return {};
    return {{"direction", "[1, 0, 0]"}};
  }
  if (table == "around") return {{"point", "[0, 0, 0]"}, {"axis", "[0, 0, 1]"}};
  if (table == "material") return {{"young", "1"}, {"poisson", "0.3"}};
  if (table == "crack") return {{"elements", "[0]"}, {"mouth", "[0, 0, 0]"}, {"tip", "[1, 0, 0]"}};
  if (table == "interface") {
    return {{"between", "[\"a\", \"b\"]"}, {"strength", "1"}, {"energy", "1"}};
  }
  if (table == "destroy") return {{"step", "0"}};
  if (table == "dynamics" && key != "time_step") return {{"time_step", "0.005"}};
  if (table != "instrument") return {};
  const std::vector<std::string> nodes = key_names("nodes");
  const bool selects = std::find(nodes.begin(), nodes.end(), key) != nodes.end();
  Lines lines = expansion;
  if (!selects) lines.push_back({"nodes", "[0]"});
  return lines;
}

/// A scene with `key = value` in its table beside `lines`.
std::string scene_with(const std::string& table, const std::string& key, const std::string& value,
                       const Lines& lines) {
  std::string text = "mesh = \"m.msh\"\n";
  if (table.empty()) return (key == "mesh" ? "" : text) + key + " = " + value + '\n';
  const bool several =
      std::any_of(scene_keys().begin(), scene_keys().end(), [&](const SceneKey& row) {
        return row.table.empty() && row.name == table && row.type == KeyType::tables;
      });
  if (table == "fibres" || table == "around") {
    text += "[material.m]\nyoung = 1\npoisson = 0.3\n[material.m.fibres";
    text += table == "around" ? ".around]\n" : "]\n";
  } else
    text += several ? "[[" + table + "]]\n" : "[" + table + (table == "material" ? ".m]\n" : "]\n");
  for (const auto& [name, of_it] : lines) {
    if (name != key) text += name + " = " + of_it + '\n';
  }
  return key.empty() ? text : text + key + " = " + value + '\n';
}

std::string refusal(KeyType type) {
  switch (type) {
    case KeyType::number:
      return "takes a number, not the boolean true";
    case KeyType::integer:
      return "takes an integer, not the boolean true";
    case KeyType::boolean:
      return "takes true or false, not the integer 3";
    case KeyType::vector:
      return "takes 3 numbers [x, y, z], not the boolean true";
    case KeyType::points:
      return "takes 2 points [[x, y, z], [x, y, z]], not the boolean true";
    case KeyType::curve:
      return "takes 2 or more points [[x, y, z], [x, y, z], ...], not the boolean true";
    case KeyType::range:
      return "takes an array of 2 numbers, not the boolean true";
    case KeyType::ids:
      return "takes an array of ids, not the boolean true";
    case KeyType::texts:
      return "takes an array of strings, not the boolean true";
    case KeyType::table:
      return "takes a table [";
    case KeyType::tables:
      return "takes tables [[";
    default:
      return "takes a string, not the boolean true";
  }
}

/// The tables in which a key of `table` stands.
std::vector<std::string> places(std::string_view table) {
  if (table == "nodes") return {"fixed", "instrument"};
  return {std::string(table)};
}

TEST(SceneKeys, TheReaderTakesNothingOfAnotherType) {
  for (const SceneKey& key : scene_keys()) {
    if (key.type == KeyType::nodes) continue;
    for (const std::string& table : places(key.table)) {
      const std::string name(key.name);
      SCOPED_TRACE(table + '.' + name);
      const std::string wrong = key.type == KeyType::boolean ? "3" : "true";
      const std::string text = scene_with(table, name, wrong, company(table, name));
      expect_input_error([&] { parse(text); }, InputFault::wrong_type, {name, refusal(key.type)});
    }
  }
}

TEST(SceneKeys, TheReaderNamesTheKeysOfEachTable) {
  for (const SceneKey& key : scene_keys()) {
    const bool table = key.type == KeyType::table || key.type == KeyType::tables;
    if (!table) continue;
    const std::string name(key.name);
    SCOPED_TRACE(name);
    expect_input_error([&] { parse(scene_with(name, "zzzzzzzzzzzz", "1", {})); },
                       InputFault::unknown_key,
                       {"unknown key", app::quoted_list(key_names(name), "and")});
  }
  expect_input_error([] { parse(scene_with("", "zzzzzzzzzzzz", "1", {})); },
                     InputFault::unknown_key, {app::quoted_list(key_names(""), "and")});
}

TEST(SceneKeys, TheReaderMissesWhatIsNeeded) {
  int needed = 0;
  for (const SceneKey& key : scene_keys()) {
    if (!key.required || key.table.empty()) continue;
    ++needed;
    const std::string name(key.name), table(key.table);
    SCOPED_TRACE(table + '.' + name);
    Lines lines = company(table, name);
    std::erase_if(lines, [&](const auto& line) { return line.first == name; });
    expect_input_error([&] { parse(scene_with(table, "", "", lines)); }, InputFault::missing_key,
                       {name, "is missing"});
  }
  // young, poisson, point, axis, kind, between, strength, energy, step, time_step
  EXPECT_EQ(needed, 10);
}

/// Every word of every option, and every default written out, as the reader takes it.
template <class Owner>
void expect_values(std::span<const MemberKey<Owner>> keys,
                   const std::function<Owner(const Scene&)>& of) {
  for (const MemberKey<Owner>& key : keys) {
    const std::string name(key.name), table(key.table);
    SCOPED_TRACE(table + '.' + name);
    for (std::size_t word = 0; word < key.words.size(); ++word) {
      const Scene scene =
          parse(scene_with(table, name, '"' + key.words[word] + '"', company(table, name)));
      EXPECT_TRUE(key.get(of(scene)) == KeyValue(static_cast<int>(word))) << key.words[word];
    }
    if (key.standard.empty()) continue;
    const Scene scene = parse(scene_with(table, name, key.standard, company(table, name)));
    EXPECT_TRUE(key.get(of(scene)) == key.get(Owner{})) << key.standard;
  }
}

TEST(SceneKeys, WordsAndDefaultsAreTheMembers) {
  expect_values<FractureOptions>(fracture_keys(), [](const Scene& s) { return s.fracture; });
  expect_values<SolverOptions>(solver_keys(), [](const Scene& s) { return s.solver; });
  expect_values<Scene>(time_keys(), [](const Scene& s) { return s; });
  expect_values<Scene>(load_keys(), [](const Scene& s) { return s; });
  expect_values<Dynamics>(dynamics_keys(), [](const Scene& s) { return *s.dynamics; });
}

TEST(SceneKeys, DampingIsTwoMembers) {
  const Scene scene = parse(
      "mesh = \"m\"\n[load]\ngravity = [1, 2, 3]\n[dynamics]\ntime_step = 0.5\n"
      "damping = [0.25, 0.125]");
  ASSERT_TRUE(scene.dynamics);
  EXPECT_EQ(scene.dynamics->time_step, 0.5);
  EXPECT_EQ(scene.dynamics->mass_damping, 0.25);
  EXPECT_EQ(scene.dynamics->stiffness_damping, 0.125);
  EXPECT_EQ(scene.gravity, Vec3(1, 2, 3));
  EXPECT_FALSE(parse("mesh = \"m\"").dynamics);
}

TEST(SceneKeys, BirthIsOneOfThem) {
  const auto words = key_words("fracture", "birth");
  EXPECT_EQ(words, (std::vector<std::string>{"element", "through"}));
  EXPECT_EQ(parse("mesh = \"m\"\n[fracture]\nbirth = \"through\"").fracture.birth,
            CrackBirth::through);
}

TEST(SceneKeys, PresetsAreTheTissues) {
  EXPECT_EQ(key_words("material", "preset"), preset_names());
}

TEST(SceneKeys, TheTissuesPageIsTheTable) {
  EXPECT_EQ(read_bytes(SUNDER_SOURCE "/docs/tissues.md"), tissues_page())
      << "write it anew with: scene_keys " SUNDER_SOURCE;
}

// A number without a source, or a source without a year, is no data.
TEST(SceneKeys, EveryNumberOfATissueHasItsSource) {
  std::string last;
  for (const TissuePreset& preset : tissue_presets()) {
    SCOPED_TRACE(std::string(preset.name));
    EXPECT_LT(last, preset.name) << "by name";
    last = preset.name;
    EXPECT_FALSE(preset.toughness && preset.energy);
    EXPECT_GT(preset.young.value, 0);
    for (const std::optional<SourcedValue>& value :
         {std::optional(preset.young), std::optional(preset.poisson), preset.yield,
          preset.toughness, preset.energy, preset.density}) {
      if (!value) continue;
      const std::string source(value->source);
      EXPECT_TRUE(source.find("19") != std::string::npos || source.find("20") != std::string::npos)
          << source;
    }
  }
}

TEST(SceneKeys, EachStandsOnce) {
  std::set<std::pair<std::string_view, std::string_view>> seen;
  for (const SceneKey& key : scene_keys()) {
    EXPECT_TRUE(seen.emplace(key.table, key.name).second) << key.table << '.' << key.name;
    EXPECT_FALSE(key.meaning.empty()) << key.table << '.' << key.name;
  }
}

TEST(SceneKeys, TheDocumentHasThemAll) {
  const std::string page = read_bytes(SUNDER_SOURCE "/docs/interface.md");
  EXPECT_TRUE(page == with_key_table(page)) << "write it anew with: scene_keys " SUNDER_SOURCE;
}

TEST(SceneKeys, TheFuzzersDictionaryHasThemAll) {
  EXPECT_EQ(read_bytes(SUNDER_SOURCE "/tests/fuzz/scene.dict"), scene_dictionary())
      << "write it anew with: scene_keys " SUNDER_SOURCE;
}

}  // namespace
}  // namespace sunder::test
