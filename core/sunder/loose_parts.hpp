// SPDX-License-Identifier: Apache-2.0
// What damage has set loose: nodes held by destroyed elements only, and pieces of live elements
// that nothing holds any more.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder {

struct LooseParts {
  std::vector<Index> isolated_nodes;       ///< no live element left, ascending
  std::vector<std::vector<Index>> pieces;  ///< live elements of each free piece, ascending
  [[nodiscard]] bool none() const { return isolated_nodes.empty() && pieces.empty(); }
};

/// Pieces connect through shared nodes; a piece is loose when supports and grips leave it a rigid
/// mode. `destroyed`: shape (elements).
[[nodiscard]] LooseParts find_loose_parts(const Problem& problem,
                                          std::span<const std::uint8_t> destroyed);
/// Of a body that split cracks have opened (Simulation::mesh()).
[[nodiscard]] LooseParts find_loose_parts(const Problem& problem,
                                          std::span<const std::uint8_t> destroyed,
                                          const Mesh& body);

}  // namespace sunder
