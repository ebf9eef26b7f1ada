// SPDX-License-Identifier: Apache-2.0
#include "app/input/scene_toml.hpp"

#include <sstream>

#include "app/input/file_bytes.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/scene_overrides.hpp"
#include "app/input/scene_sections.hpp"
#include "app/input/toml_guard.hpp"
#include "app/system/utf8_path.hpp"
#include "sunder/scene_keys.hpp"

namespace sunder::app {
namespace {

constexpr std::size_t kLargestScene = 64U << 20U;  // bytes; a scene is written by hand

toml::table parse_toml(std::string_view text, const std::string& source) {
  if (const auto line = stray_character_line(text)) {
    throw InputError(InputFault::syntax,
                     source + ":" + std::to_string(*line) +
                         ": not valid TOML: a character that is not ASCII outside quotes");
  }
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw InputError(InputFault::syntax, location(error.source(), source) + ": not valid TOML: " +
                                             std::string(error.description()));
  }
}

/// What begins messages about a scene.
std::string source_of(const std::filesystem::path& path, const std::string* text) {
  return path.string() + (text ? " (the scene of this mesh)" : "");
}

ParsedScene read_with_mesh(const std::filesystem::path& path, const std::string* text,
                           const std::vector<std::string>& overrides,
                           std::vector<std::string>* warnings) {
  ParsedScene parsed =
      parse_scene(text ? *text : scene_text(path), source_of(path, text), overrides);
  parsed.scene.mesh =
      import_mesh(path.parent_path() / system::utf8_path(parsed.mesh_path), warnings);
  return parsed;
}

}  // namespace

ParsedScene parse_scene(std::string_view text, const std::string& source,
                        const std::vector<std::string>& overrides,
                        const std::vector<std::string>& varied) {
  toml::table parsed = parse_toml(text, source);
  for (const std::string& override_text : overrides) apply_override(parsed, override_text);
  for (const std::string& override_text : varied) apply_override(parsed, override_text, "--vary");

  const TomlTable root(parsed, source, "", key_names(""));
  ParsedScene result;
  Scene& scene = result.scene;
  scene.source = source;
  scene.title = root.text("title").value_or(system::utf8_path(source).stem().string());
  result.mesh_path = root.require("mesh", root.text("mesh"));
  if (result.mesh_path.empty())
    root.fail(InputFault::out_of_range, "mesh", "is empty; allowed: the path of a mesh file");
  scene.materials = read_materials(root, source);
  scene.supports = read_supports(root, source);
  scene.instruments = read_instruments(root, source);
  scene.cracks = read_cracks(root, source);
  scene.interfaces = read_interfaces(root, source);
  scene.removals = read_removals(root, source);
  scene.fracture = read_fracture(root, source);
  scene.solver = read_solver(root, source);
  scene.steps = read_steps(root, source);
  scene.output = read_output(root, source);
  scene.gravity = read_gravity(root, source);
  scene.dynamics = read_dynamics(root, source);
  if (const auto inputs = root.text("inputs")) {
    if (inputs->empty()) {
      root.fail(InputFault::out_of_range, "inputs", "is empty; allowed: the path of a text file");
    }
    result.inputs_path = *inputs;
    scene.live = true;
  }
  if (const auto recording = root.text("recording")) {
    if (recording->empty()) {
      root.fail(InputFault::out_of_range, "recording",
                "is empty; allowed: the path of a recording");
    }
    if (!result.inputs_path.empty()) {
      root.fail(InputFault::unknown_key, "recording", "stands beside inputs; allowed: one of them");
    }
    result.recording_path = *recording;
    scene.live = true;
  }
  result.places = collect_places(parsed, source);
  return result;
}

void refuse_played(const ParsedScene& parsed) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(InputFault::unknown_key,
                     parsed.scene.source + ": " + what + "; leave the key out here");
  };
  if (!parsed.inputs_path.empty()) refuse("inputs is for sunder run, plan and view");
  if (!parsed.recording_path.empty()) refuse("recording is for sunder run and plan");
}

std::string scene_text(const std::filesystem::path& path) { return read_file(path, kLargestScene); }

Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides,
                 std::vector<std::string>* warnings) {
  return read_with_mesh(path, nullptr, overrides, warnings).scene;
}

std::string scene_text_for(const std::filesystem::path& path,
                           const std::vector<std::string>& overrides,
                           const std::filesystem::path& folder, const std::string& inputs,
                           const std::string* text) {
  const std::string source = source_of(path, text);
  toml::table parsed = parse_toml(text ? *text : scene_text(path), source);
  for (const std::string& override_text : overrides) apply_override(parsed, override_text);
  const TomlTable root(parsed, source, "", key_names(""));
  const std::filesystem::path mesh =
      path.parent_path() / system::utf8_path(root.require("mesh", root.text("mesh")));
  const auto absolute = [](const std::filesystem::path& p) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(p));
  };
  parsed.insert_or_assign("mesh", absolute(mesh).lexically_proximate(absolute(folder)).string());
  if (!root.has("title")) parsed.insert_or_assign("title", path.stem().string());
  parsed.erase("inputs");
  parsed.erase("recording");
  if (!inputs.empty()) parsed.insert_or_assign("inputs", inputs);
  std::ostringstream out;
  out << toml::toml_formatter(parsed) << "\n";
  return out.str();
}

std::shared_ptr<const Problem> read_problem(const std::filesystem::path& path,
                                            const std::vector<std::string>& overrides,
                                            std::vector<std::string>* warnings, PlayedFiles* played,
                                            bool live, const std::string* text) {
  ParsedScene parsed = read_with_mesh(path, text, overrides, warnings);
  if (!played) refuse_played(parsed);
  const auto beside = [&](const std::string& file) {
    return file.empty() ? std::filesystem::path() : path.parent_path() / system::utf8_path(file);
  };
  if (played) *played = {beside(parsed.inputs_path), beside(parsed.recording_path)};
  parsed.scene.live = parsed.scene.live || live;
  try {
    return std::make_shared<const Problem>(std::move(parsed.scene));
  } catch (const InputError& error) {
    throw parsed.places.located(error);
  }
}

}  // namespace sunder::app
