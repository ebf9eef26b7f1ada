// SPDX-License-Identifier: Apache-2.0
#include "app/input/scene_toml.hpp"

#include "app/input/file_bytes.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/scene_overrides.hpp"
#include "app/input/scene_sections.hpp"
#include "app/input/toml_guard.hpp"
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

ParsedScene read_with_mesh(const std::filesystem::path& path,
                           const std::vector<std::string>& overrides,
                           std::vector<std::string>* warnings) {
  ParsedScene parsed = parse_scene(scene_text(path), path.string(), overrides);
  parsed.scene.mesh = import_mesh(path.parent_path() / parsed.mesh_path, warnings);
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
  scene.title = root.text("title").value_or(std::filesystem::path(source).stem().string());
  result.mesh_path = root.require("mesh", root.text("mesh"));
  if (result.mesh_path.empty())
    root.fail(InputFault::out_of_range, "mesh", "is empty; allowed: the path of a mesh file");
  scene.materials = read_materials(root, source);
  scene.supports = read_supports(root, source);
  scene.instruments = read_instruments(root, source);
  scene.cracks = read_cracks(root, source);
  scene.removals = read_removals(root, source);
  scene.fracture = read_fracture(root, source);
  scene.solver = read_solver(root, source);
  scene.steps = read_steps(root, source);
  scene.output = read_output(root, source);
  scene.gravity = read_gravity(root, source);
  scene.dynamics = read_dynamics(root, source);
  result.places = collect_places(parsed, source);
  return result;
}

std::string scene_text(const std::filesystem::path& path) { return read_file(path, kLargestScene); }

Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides,
                 std::vector<std::string>* warnings) {
  return read_with_mesh(path, overrides, warnings).scene;
}

std::shared_ptr<const Problem> read_problem(const std::filesystem::path& path,
                                            const std::vector<std::string>& overrides,
                                            std::vector<std::string>* warnings) {
  ParsedScene parsed = read_with_mesh(path, overrides, warnings);
  try {
    return std::make_shared<const Problem>(std::move(parsed.scene));
  } catch (const InputError& error) {
    throw parsed.places.located(error);
  }
}

}  // namespace sunder::app
