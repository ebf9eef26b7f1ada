// SPDX-License-Identifier: Apache-2.0
// Patches of pooled volume (pools.hpp) as damage has split them: cracks of split nodes part a patch
// whose elements no longer hang together by faces, and a piece that comes off shares none with what
// it came from.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::fem {

/// A body as it stands: who has left, and the corners of those that are there.
struct StandingBody {
  const Problem& problem;
  std::span<const std::uint8_t> destroyed;  ///< per element of the mesh; empty: none
  const std::function<const std::array<Index, 4>&(Index element)>& corners;
  std::span<const Index> split;  ///< elements whose corners are not the mesh's
};

class DamagedPools {
 public:
  /// Follows an event that has changed these elements. Searches the body for pieces where the live
  /// elements of some patch hang together only through others.
  void follow(const StandingBody& body, std::span<const Index> elements);
  /// Null: they are the problem's.
  [[nodiscard]] const std::shared_ptr<const Pools>& split() const { return split_; }
  [[nodiscard]] const Pools* of(const Problem& problem) const {
    return split_ ? split_.get() : problem.pools();
  }

 private:
  std::vector<Index> candidates_;  // of the problem's patches, ascending
  std::shared_ptr<const Pools> split_;
};

}  // namespace sunder::fem
