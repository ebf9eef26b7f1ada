// SPDX-License-Identifier: Apache-2.0
// What damage has set loose, by graph search: nodes held by destroyed elements only, and pieces of
// live elements that nothing holds any more.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fem/supports.hpp"
#include "sunder/problem.hpp"

namespace sunder {

struct LooseParts {
  std::vector<Index> isolated_nodes;       ///< no live element left, ascending
  std::vector<std::vector<Index>> pieces;  ///< live elements of each free piece, ascending
  [[nodiscard]] bool none() const { return isolated_nodes.empty() && pieces.empty(); }
};

/// Finds them again and again in one body, with lists of its own: a frame allocates nothing.
class LooseSearch {
 public:
  explicit LooseSearch(const Problem& problem);
  void look(std::span<const std::uint8_t> destroyed);

  // Of the last look:
  [[nodiscard]] std::size_t isolated_nodes() const { return isolated_; }
  [[nodiscard]] std::size_t pieces() const { return pieces_; }
  [[nodiscard]] std::size_t elements_cut_off() const { return cut_off_; }
  [[nodiscard]] bool isolated(Index node) const {
    return bodies_.body_of_node[node] == kNone && used_[static_cast<std::size_t>(node)] != 0;
  }
  /// By their first element; kNone: held, or destroyed.
  [[nodiscard]] Index piece_of(Index element) const {
    const Index body = bodies_.body_of_element[element];
    return body == kNone ? kNone : piece_of_body_[static_cast<std::size_t>(body)];
  }

 private:
  void sort_held();

  const Problem& problem_;
  fem::Bodies bodies_;
  fem::BodyRoom room_;
  std::vector<fem::HeldDof> all_held_, held_;  // of the whole; sorted by body
  std::vector<std::uint8_t> used_;             // per node: belongs to an element
  std::size_t unused_ = 0;
  std::vector<std::size_t> held_end_;  // per body
  std::vector<Index> piece_of_body_;
  std::size_t isolated_ = 0, pieces_ = 0, cut_off_ = 0;
};

/// Pieces connect through shared nodes; a piece is loose when supports and grips leave it a rigid
/// mode.
[[nodiscard]] LooseParts find_loose_parts(const Problem& problem,
                                          std::span<const std::uint8_t> destroyed);

}  // namespace sunder
