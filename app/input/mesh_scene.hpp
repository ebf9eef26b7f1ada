// SPDX-License-Identifier: Apache-2.0
// A scene for a mesh alone, so that a body of one's own can be looked at, pulled and torn at once:
// held at one end, gripped at the other, of the constants of liver.
#pragma once

#include <filesystem>
#include <string>

namespace sunder::app {

/// Reads the mesh for its extent and its volumes; returns a scene's text that reads from its
/// folder. Throws InputError.
[[nodiscard]] std::string mesh_scene_text(const std::filesystem::path& path);

}  // namespace sunder::app
