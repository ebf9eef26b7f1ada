// SPDX-License-Identifier: Apache-2.0
// A scene under construction.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "c/handles.hpp"
#include "sunder/problem.hpp"

namespace sunder::c {

class SceneObject final : public Object {
 public:
  static constexpr const char* kName = "scene";

  Scene scene;  ///< its mesh has one volume per material
  std::vector<Material> materials;
  std::map<std::string, std::vector<Vec3>> fields;  ///< of the mesh that will be there, by name
  std::vector<NamedSurface> surfaces;               ///< likewise, of selections by faces
  bool attribution = false;
  std::vector<std::byte> pipeline_cache;  ///< that the host has kept

  /// Checks everything. Throws InputError.
  [[nodiscard]] std::shared_ptr<const Problem> problem() const;
};

/// Throw SUNDER_ERROR_VALUE, _NULL or _SIZE. Faces become a surface of the scene's: what else may
/// be refused comes before.
[[nodiscard]] NodeSelection to_nodes(SceneObject& object, const sunder_selection& selection,
                                     const char* what);
[[nodiscard]] ElementSelection to_elements(const sunder_selection& selection, const char* what);

}  // namespace sunder::c
