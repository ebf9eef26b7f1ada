// SPDX-License-Identifier: Apache-2.0
#include "app/input/scene_toml.hpp"

#include "app/input/file_bytes.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/scene_overrides.hpp"
#include "app/input/scene_sections.hpp"

namespace sunder::app {
namespace {

constexpr std::size_t kLargestScene = 64U << 20U;  // bytes; a scene is written by hand

toml::table parse_toml(std::string_view text, const std::string& source) {
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw InputError(InputFault::syntax, location(error.source(), source) + ": not valid TOML: " +
                                             std::string(error.description()));
  }
}

}  // namespace

Scene parse_scene(std::string_view text, const std::string& source,
                  const std::vector<std::string>& overrides, std::string& mesh_path) {
  toml::table parsed = parse_toml(text, source);
  for (const std::string& override_text : overrides) apply_override(parsed, override_text);

  const TomlTable root(parsed, source, "",
                       {"title", "mesh", "material", "fixed", "instrument", "crack", "destroy",
                        "fracture", "solver", "time", "output"});
  Scene scene;
  scene.source = source;
  scene.title = root.text("title").value_or(std::filesystem::path(source).stem().string());
  mesh_path = root.require("mesh", root.text("mesh"));
  if (mesh_path.empty())
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
  return scene;
}

Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides,
                 std::vector<std::string>* warnings) {
  std::string mesh_path;
  Scene scene = parse_scene(read_file(path, kLargestScene), path.string(), overrides, mesh_path);
  scene.mesh = import_mesh(path.parent_path() / mesh_path, warnings);
  return scene;
}

}  // namespace sunder::app
