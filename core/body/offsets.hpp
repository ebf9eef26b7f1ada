// SPDX-License-Identifier: Apache-2.0
// The unknowns that split nodes bring (method.md "Changes" 14): offsets of new nodes to their
// parents. Unknowns of the mesh come first, then these, by node and axis.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "body/change.hpp"

namespace sunder::fem {

class Offsets {
 public:
  /// Takes the new nodes of some forms: those that have come since the last call, or all of them
  /// where an event was taken back.
  void follow(const Forms& forms);
  [[nodiscard]] bool empty() const { return unknowns_.empty(); }
  /// How many unknowns.
  [[nodiscard]] Index count() const { return count_; }
  [[nodiscard]] std::span<const NewNode> nodes() const { return nodes_; }
  /// Which of them a new node (0: the first one) has on an axis; kNone: there it keeps to its
  /// parent.
  [[nodiscard]] Index unknown(Index added, int axis) const {
    return unknowns_[static_cast<std::size_t>(added)][static_cast<std::size_t>(axis)];
  }

  /// Displacement at new nodes, `nodal` (3 * all nodes) having that of the mesh's: the parent's and
  /// the offset `d`.
  void move(std::span<const double> d, std::span<double> nodal) const;
  /// Forces on offsets from those on all nodes, and those of the ties and springs under
  /// the offsets `d`.
  void gather(std::span<const double> nodal, std::span<const double> d,
              std::span<double> forces) const;

 private:
  std::vector<NewNode> nodes_;
  std::vector<std::array<Index, 3>> unknowns_;
  Index count_ = 0;
};

}  // namespace sunder::fem
