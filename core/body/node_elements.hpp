// SPDX-License-Identifier: Apache-2.0
// Elements around each node, ascending, in one compressed list.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sunder/mesh.hpp"

namespace sunder {

class NodeElements {
 public:
  explicit NodeElements(const Mesh& mesh);
  [[nodiscard]] std::span<const Index> of(Index node) const {
    return {elements_.data() + begin_[node], begin_[node + 1] - begin_[node]};
  }

 private:
  std::vector<std::size_t> begin_;  // shape (nodes + 1)
  std::vector<Index> elements_;     // shape (4 * elements)
};

}  // namespace sunder
