// SPDX-License-Identifier: Apache-2.0
// Where fibres run in an element (method.md "Fibres").
#pragma once

#include <memory>
#include <string>

#include "sunder/scene.hpp"

namespace sunder::fem {

/// What a family's directions are, of all elements of a mesh.
class FibreDirections {
 public:
  virtual ~FibreDirections() = default;
  /// Unit vector in an element, whose volume is that [mm^3]. Throws InputError where there is none.
  [[nodiscard]] virtual Vec3 in(Index element, double volume) const = 0;
};

/// Throws InputError for what no mesh has directions by. `what` begins messages; the mesh and
/// `fibres` must outlive it.
[[nodiscard]] std::unique_ptr<FibreDirections> directions_of(const Fibres& fibres, const Mesh& mesh,
                                                             const std::string& what);

}  // namespace sunder::fem
