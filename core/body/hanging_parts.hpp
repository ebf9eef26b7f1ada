// SPDX-License-Identifier: Apache-2.0
// Parts of a body that hang on the rest by a node or an edge, like a door without a latch: their
// turning costs no energy, so the stiffness is singular although the body is held.
#pragma once

#include <span>
#include <vector>

#include "body/supports.hpp"
#include "sunder/mesh.hpp"

namespace sunder {

struct HangingPart {
  Index elements = 0;
  Index first = kNone;  ///< element
  /// As few dofs as stop its turning. Nothing else acts there unless a load does, so that they
  /// carry nothing and the rest is as it would be without them.
  std::vector<fem::HeldDof> latches;
};

/// Parts that faces join and that shared nodes attach to one other part (or all at one node), and
/// so on for what is left without them. `restrained`: per node, whether a support or a grip holds
/// something of it; a part with such a node of its own does not hang.
[[nodiscard]] std::vector<HangingPart> find_hanging_parts(const Mesh& mesh,
                                                          const fem::Bodies& bodies,
                                                          std::span<const std::uint8_t> restrained);

}  // namespace sunder
