// SPDX-License-Identifier: Apache-2.0
// Scenes in TOML 1.0 (docs/interface.md "Scene"): strict, every key known, every type checked, each
// error with file:line:column. What a value may be physically is Problem's matter.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sunder/scene.hpp"

namespace sunder::app {

/// Reads a scene and its mesh. `overrides` are texts "key.path=value" (--set), applied in order.
/// Findings that are no errors (nodes dropped, ...) are appended to `warnings`.
/// Throws InputError.
[[nodiscard]] Scene read_scene(const std::filesystem::path& path,
                               const std::vector<std::string>& overrides = {},
                               std::vector<std::string>* warnings = nullptr);

/// The same from text, without the mesh: Scene::mesh stays empty, `mesh_path` receives the value
/// of the key `mesh` as written. `source` begins messages.
[[nodiscard]] Scene parse_scene(std::string_view text, const std::string& source,
                                const std::vector<std::string>& overrides, std::string& mesh_path);

}  // namespace sunder::app
