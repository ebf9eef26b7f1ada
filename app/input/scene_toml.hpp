// SPDX-License-Identifier: Apache-2.0
// Scenes in TOML 1.0 (docs/interface.md "Scene"): strict, every key known, every type checked, each
// error with file:line:column. What a value may be physically is Problem's matter.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "app/input/scene_places.hpp"
#include "sunder/problem.hpp"

namespace sunder::app {

/// Reads a scene and its mesh. `overrides` are texts "key.path=value" (--set), applied in order.
/// Findings that are no errors (nodes dropped, ...) are appended to `warnings`.
/// Throws InputError.
[[nodiscard]] Scene read_scene(const std::filesystem::path& path,
                               const std::vector<std::string>& overrides = {},
                               std::vector<std::string>* warnings = nullptr);

/// Files that a scene names for what is done between its steps; empty: none.
struct PlayedFiles {
  std::filesystem::path inputs, recording;
};

/// Reads a scene and makes it a Problem, whose errors are reported with their place in the file.
/// `played`: gets the paths of what is done beside the scene's own loads; null: a scene with such
/// is refused. `live`: the problem is so whatever the scene says (Scene::live). `text`: the scene
/// in place of the file's text, for a file that is a mesh; null: the file has it.
[[nodiscard]] std::shared_ptr<const Problem> read_problem(
    const std::filesystem::path& path, const std::vector<std::string>& overrides = {},
    std::vector<std::string>* warnings = nullptr, PlayedFiles* played = nullptr, bool live = false,
    const std::string* text = nullptr);

/// A scene's text, read; Scene::mesh is empty.
struct ParsedScene {
  Scene scene;
  std::string mesh_path;       ///< the value of the key `mesh`, as written
  std::string inputs_path;     ///< likewise of `inputs`; empty: there are none
  std::string recording_path;  ///< likewise of `recording`; with neither Scene::live is off
  ScenePlaces places;
};

/// `source` (the file) begins messages; `varied` are overrides of --vary, which come last. Throws
/// InputError.
[[nodiscard]] ParsedScene parse_scene(std::string_view text, const std::string& source,
                                      const std::vector<std::string>& overrides = {},
                                      const std::vector<std::string>& varied = {});

/// Throws InputError where a scene has inputs or a recording: nobody would carry them out.
void refuse_played(const ParsedScene& parsed);

/// The scene of a file with its overrides, as a text that reads the same from `folder`; its key
/// `inputs` is `inputs`, or absent where that is empty. Comments are lost. `text`: as
/// read_problem() has it. Throws InputError.
[[nodiscard]] std::string scene_text_for(const std::filesystem::path& path,
                                         const std::vector<std::string>& overrides,
                                         const std::filesystem::path& folder,
                                         const std::string& inputs,
                                         const std::string* text = nullptr);

/// The text of a scene's file. Throws InputError.
[[nodiscard]] std::string scene_text(const std::filesystem::path& path);

}  // namespace sunder::app
