// SPDX-License-Identifier: Apache-2.0
// A body of one's own without a scene: one with defaults that a hand can tear.
#pragma once

#include <filesystem>
#include <string>

#include "sunder/mesh.hpp"

namespace sunder::app {

/// The text of a scene: every volume soft tissue, held where the body is lowest along its longest
/// axis, torn by model A, as many steps as a hand needs. `file`: the mesh, absolute.
[[nodiscard]] std::string scene_of_mesh(const Mesh& mesh, const std::filesystem::path& file);

/// The same of a mesh file. Throws InputError where it cannot be read.
[[nodiscard]] std::string scene_of_mesh(const std::filesystem::path& file);

}  // namespace sunder::app
