// SPDX-License-Identifier: Apache-2.0
// The region of a condensed body as a Problem of its own, which a device computes the fields of,
// with the numbers that its nodes and elements have there.
#pragma once

#include <memory>
#include <vector>

#include "solver/region.hpp"

namespace sunder::solver {

class RegionPart {
 public:
  RegionPart(const Problem& whole, const Region& region);

  /// Element i of it is region.elements[i], node i nodes()[i].
  [[nodiscard]] const std::shared_ptr<const Problem>& problem() const { return part_; }
  /// Nodes of the body, ascending.
  [[nodiscard]] const std::vector<Index>& nodes() const { return part_of_body_.nodes; }
  /// Elements of the body, ascending.
  [[nodiscard]] const std::vector<Index>& elements() const { return part_of_body_.elements; }
  /// Place of an element of the body in the part, kNone: outside.
  [[nodiscard]] Index element(Index of_body) const { return element_[of_body]; }
  /// Of a node; kNone also for one that is held and belongs to no element of the part.
  [[nodiscard]] Index node(Index of_body) const { return node_[of_body]; }

 private:
  std::vector<Index> node_, element_;
  PartOfBody part_of_body_;
  std::shared_ptr<const Problem> part_;
};

}  // namespace sunder::solver
