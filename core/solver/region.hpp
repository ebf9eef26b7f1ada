// SPDX-License-Identifier: Apache-2.0
// The part of a body that a frame looks at: what can break, what instruments hold or pull, what is
// torn from the start or by script. All else of a large body only hands its stiffness on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sunder/backend.hpp"

namespace sunder::solver {

/// A region is condensed by itself up to this share of all unknowns: a frame then reads a quarter
/// of what it would read of the dense inverse, and a few per cent of a large factor. Beyond, a
/// picture, which needs one solve with the factor, eats up the gain.
inline constexpr std::size_t kRegionShare = 4;

struct Region {
  std::vector<Index> nodes;          ///< with an unknown in the region, ascending
  std::vector<Index> dofs;           ///< all unknowns of these nodes, ascending
  std::vector<Index> elements;       ///< whose corners are all in the region or held, ascending
  std::vector<std::uint8_t> inside;  ///< per node: in `nodes`, or without unknowns
  bool tears = false;                ///< the scene itself names elements that can be destroyed
};

/// `beyond`: elements that shall be in it besides.
[[nodiscard]] Region region_of(const Problem& problem, const Needs& needs,
                               std::span<const Index> beyond = {});

/// What a frame that computes a region alone leaves out, in words.
[[nodiscard]] std::vector<std::string> left_out_of(const Problem& problem, const Region& region);

}  // namespace sunder::solver
