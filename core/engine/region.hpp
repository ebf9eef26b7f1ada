// SPDX-License-Identifier: Apache-2.0
// The part of a body that a frame looks at: what can break, what instruments hold or pull, what is
// torn from the start or by script. All else of a large body only hands its stiffness on.
#pragma once

#include <cstdint>
#include <vector>

#include "sunder/backend.hpp"

namespace sunder::engine {

struct Region {
  std::vector<Index> nodes;          ///< with an unknown in the region, ascending
  std::vector<Index> dofs;           ///< all unknowns of these nodes, ascending
  std::vector<Index> elements;       ///< whose corners are all in the region or held, ascending
  std::vector<std::uint8_t> inside;  ///< per node: in `nodes`, or without unknowns
  bool tears = false;                ///< the scene itself names elements that can be destroyed
};

[[nodiscard]] Region region_of(const Problem& problem, const Needs& needs);

}  // namespace sunder::engine
