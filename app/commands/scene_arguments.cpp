// SPDX-License-Identifier: Apache-2.0
#include "app/commands/scene_arguments.hpp"

#include <utility>

#include "app/input/file_bytes.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/scene_toml.hpp"
#include "sunder/error.hpp"

namespace sunder::app {

std::vector<std::string> overrides_of(const SceneArguments& arguments) {
  std::vector<std::string> all = arguments.set;
  const auto add_word = [&](const char* key, const std::optional<std::string>& word) {
    if (word) all.push_back(std::string(key) + "=\"" + *word + "\"");
  };
  const auto add_number = [&](const char* key, const std::optional<int>& value) {
    if (value) all.push_back(std::string(key) + "=" + std::to_string(*value));
  };
  add_word("solver.backend", arguments.backend);
  add_word("solver.route", arguments.route);
  add_word("solver.update", arguments.update);
  add_word("solver.precision", arguments.precision);
  add_number("solver.device", arguments.device);
  add_number("time.steps", arguments.steps);
  return all;
}

OpenedScene open_scene(const SceneArguments& arguments, bool live) {
  if (!arguments.text && is_mesh_file(arguments.scene)) {
    const std::string file = arguments.scene.string();
    throw InputError(InputFault::unreadable_file,
                     file +
                         ": is a mesh, not a scene; write a scene that names it "
                         "(docs/interface.md \"Scene\"), or look at it by `sunder view " +
                         file + "`");
  }
  OpenedScene opened;
  constexpr std::size_t kLargestRecording = std::size_t{1} << 30;  // bytes
  PlayedFiles played;
  opened.problem = read_problem(arguments.scene, overrides_of(arguments), &opened.warnings, &played,
                                live, arguments.text ? &*arguments.text : nullptr);
  if (!played.recording.empty()) {
    const std::string bytes = read_file(played.recording, kLargestRecording);
    opened.recording.assign(bytes.begin(), bytes.end());
    opened.recording_file = played.recording;
  }
  if (played.inputs.empty()) return opened;
  opened.inputs = read_inputs(played.inputs.string());
  resolve(*opened.inputs, *opened.problem);
  return opened;
}

}  // namespace sunder::app
