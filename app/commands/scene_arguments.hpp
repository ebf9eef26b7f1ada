// SPDX-License-Identifier: Apache-2.0
// What `run` and `plan` take alike: a scene and what overrides it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/inputs/inputs.hpp"
#include "sunder/problem.hpp"

namespace sunder::app {

struct SceneArguments {
  std::filesystem::path scene;
  std::optional<std::string> text;  ///< of the scene, where the file is a mesh
  std::optional<std::string> backend, route, update, precision;
  std::optional<int> device, steps;
  std::vector<std::string> set;  ///< "key.path=value"
};

/// All of them as texts of --set, the named options last.
[[nodiscard]] std::vector<std::string> overrides_of(const SceneArguments& arguments);

struct OpenedScene {
  std::shared_ptr<const Problem> problem;
  std::vector<std::string> warnings;  ///< of reading; the problem's own come on top
  std::optional<Inputs> inputs;       ///< that the scene names, resolved
  /// That the scene names, and its file; empty: none.
  std::vector<std::uint8_t> recording;
  std::filesystem::path recording_file;
};

/// Reads the scene and its inputs; the named options win over --set. `live`: any element may be
/// removed, whatever the scene says. Throws InputError.
[[nodiscard]] OpenedScene open_scene(const SceneArguments& arguments, bool live = false);

}  // namespace sunder::app
