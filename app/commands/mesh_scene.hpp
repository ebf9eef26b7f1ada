// SPDX-License-Identifier: Apache-2.0
// A body of one's own without a scene: one with defaults that a hand can tear.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "sunder/mesh.hpp"

namespace sunder::app {

/// The text of a scene: every volume soft tissue, held where the body is lowest along its longest
/// axis, torn by model A, as many steps as a hand needs. `file`: the mesh, absolute.
[[nodiscard]] std::string scene_of_mesh(const Mesh& mesh, const std::filesystem::path& file);

/// Such a scene in a file of its own, in the system's folder for such, as long as this lives.
class MeshScene {
 public:
  /// Throws InputError where the mesh cannot be read or the scene cannot be written.
  explicit MeshScene(const std::filesystem::path& mesh);
  ~MeshScene();
  MeshScene(const MeshScene&) = delete;
  MeshScene& operator=(const MeshScene&) = delete;

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path folder_, file_;
};

}  // namespace sunder::app
