// SPDX-License-Identifier: Apache-2.0
// What an element has lost and gained of its stiffness between two states of a body (method.md
// "Changes").
#pragma once

#include <array>
#include <optional>

#include "body/change.hpp"
#include "body/element.hpp"

namespace sunder::fem {

/// Stiffness U U^T between nodes of the mesh.
struct StiffnessPart {
  std::array<Index, 4> nodes{};
  UpdateFactor u;
  /// Where it is a share of a patch's vector (pools.hpp): U's first column is an addend of it, the
  /// others are 0, and what stands side by side in a list with the same patch adds up.
  Index patch = kNone;
};
struct StiffnessDifference {
  std::optional<StiffnessPart> less, more;
};

/// Of an element that takes another form; where only the share differs, of that alone. `forms` know
/// the new nodes of both.
[[nodiscard]] StiffnessDifference difference(const Forms& forms, const Form& before,
                                             const Form& after);
/// Of an element between two states of one body, the later one last.
[[nodiscard]] StiffnessDifference difference(const Forms& before, const Forms& after,
                                             Index element);

}  // namespace sunder::fem
