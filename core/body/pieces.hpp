// SPDX-License-Identifier: Apache-2.0
// What damage has set loose (sunder/loose_parts.hpp), by graph search.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "body/supports.hpp"
#include "sunder/loose_parts.hpp"

namespace sunder {

/// Finds them again and again in one body, with lists of its own: a frame allocates nothing.
class LooseSearch {
 public:
  explicit LooseSearch(const Problem& problem);
  void look(std::span<const std::uint8_t> destroyed);
  /// What holds a piece besides supports, in place of what did: unknowns of the problem's grips,
  /// ascending (at first all of them), and nodes of the mesh. Whether something else holds now.
  bool hold(std::span<const Index> unknowns, std::span<const Index> nodes);
  /// Of a body in which elements have other corners than in the mesh, where nodes have come.
  void look(std::span<const std::uint8_t> destroyed, std::span<const std::array<Index, 4>> corners,
            Index nodes);

  // Of the last look:
  [[nodiscard]] std::size_t isolated_nodes() const { return isolated_; }
  [[nodiscard]] std::size_t pieces() const { return pieces_; }
  [[nodiscard]] std::size_t elements_cut_off() const { return cut_off_; }
  [[nodiscard]] bool isolated(Index node) const {
    return bodies_.body_of_node[node] == kNone && used_[static_cast<std::size_t>(node)] != 0;
  }
  /// Live elements that hang together, held or not; kNone: destroyed.
  [[nodiscard]] Index body_of(Index element) const { return bodies_.body_of_element[element]; }
  /// By their first element; kNone: held, or destroyed.
  [[nodiscard]] Index piece_of(Index element) const {
    const Index body = bodies_.body_of_element[element];
    return body == kNone ? kNone : piece_of_body_[static_cast<std::size_t>(body)];
  }

 private:
  void search(const Mesh& mesh, std::span<const std::uint8_t> destroyed);
  void follow(std::span<const std::array<Index, 4>> corners, Index nodes);
  void sort_held();
  void collect_held();

  const Problem& problem_;
  fem::Bodies bodies_;
  fem::BodyRoom room_;
  std::vector<fem::HeldDof> all_held_, held_;  // of the whole; sorted by body
  std::vector<Index> gripped_, also_held_;     // unknowns of the problem's grips; nodes
  std::size_t of_problem_ = 0;                 // of all_held_, the first ones
  std::vector<std::uint8_t> used_;             // per node: belongs to an element
  std::size_t unused_ = 0;
  std::vector<std::size_t> held_end_;  // per body
  std::vector<Index> piece_of_body_;
  Mesh split_;  // empty: no nodes have come
  std::size_t isolated_ = 0, pieces_ = 0, cut_off_ = 0;
};

}  // namespace sunder
