// SPDX-License-Identifier: Apache-2.0
// Groups of nodes whose rigid motions precondition conjugate gradients (rigid_space.hpp): parts of
// every piece of the body by its extent.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::gpu {

/// Groups that so many nodes ask for.
[[nodiscard]] Index wanted_groups(Index nodes);

/// Of so many parts, by its size of a total; at least one.
[[nodiscard]] inline Index share_of(Index parts, std::size_t size, std::size_t total) {
  return std::max<Index>(static_cast<Index>(static_cast<std::size_t>(parts) * size / total), 1);
}

class NodeGroups {
 public:
  using Lists = std::vector<std::vector<Index>>;
  /// At most so many, of so many pieces. `apart`: no group of the largest piece has nodes of
  /// volumes of unlike stiffness, every other piece is one.
  NodeGroups(const Problem& problem, Index most, Index most_pieces, bool apart);

  /// Nodes of every piece that is worth a group, the largest first.
  [[nodiscard]] Lists pieces(std::span<const std::uint8_t> destroyed) const;
  /// These pieces are those that the groups are of, or some of them, less a few nodes.
  [[nodiscard]] bool are_of(const Lists& pieces) const;
  /// Makes them of these pieces; whether they are others now.
  bool make(Lists pieces);
  void clear() { groups_.clear(); }

  [[nodiscard]] std::size_t count() const { return groups_.size(); }
  /// Ascending.
  [[nodiscard]] const std::vector<Index>& nodes(std::size_t group) const { return groups_[group]; }
  /// Groups of every piece that has some, the largest first.
  [[nodiscard]] const std::vector<std::size_t>& of_pieces() const { return of_pieces_; }
  /// Of a node; kNone: none.
  [[nodiscard]] Index of(Index node) const { return of_node_[static_cast<std::size_t>(node)]; }

 private:
  [[nodiscard]] std::vector<Index> kinds_of_nodes() const;
  void add_by_kind(const std::vector<Index>& nodes, Index most, Lists& groups) const;

  const Problem& problem_;
  Index most_, most_pieces_;
  std::vector<Index> kind_;  // of every node: groups have one alone; empty: it does not matter
  Lists groups_;
  std::vector<std::size_t> of_pieces_;
  std::vector<Index> of_node_;
  std::size_t pieces_ = 0;  // that there were, with or without groups
};

}  // namespace sunder::gpu
