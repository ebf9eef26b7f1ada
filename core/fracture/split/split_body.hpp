// SPDX-License-Identifier: Apache-2.0
// The body's elements as split cracks leave them (method.md "Split cracks"): which faces are open
// and whose corners are whose. A node whose elements no longer hang together by faces becomes as
// many nodes as there are groups of them; no node moves and no element changes its shape.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "body/change.hpp"
#include "fracture/face.hpp"
#include "sunder/problem.hpp"

namespace sunder::fracture {

class SplitBody {
 public:
  /// Intact. The problem must outlive it.
  explicit SplitBody(const Problem& problem);

  /// Nodes of the mesh and, with ids after theirs, those that splitting has added.
  [[nodiscard]] Index node_count() const { return static_cast<Index>(at_node_.size()); }
  /// The node of the mesh where a node lies.
  [[nodiscard]] Index in_mesh(Index node) const {
    const Index added = node - problem_.node_count();
    return added < 0 ? node : parents_[static_cast<std::size_t>(added)];
  }
  [[nodiscard]] const std::array<Index, 4>& corners(Index element) const {
    return corners_[static_cast<std::size_t>(element)];
  }
  [[nodiscard]] std::span<const std::array<Index, 4>> corners() const { return corners_; }
  /// Elements at a node, ascending, destroyed ones too.
  [[nodiscard]] std::span<const Index> elements_of(Index node) const {
    return at_node_[static_cast<std::size_t>(node)];
  }
  /// An element that shares a node with others that hold it; kNone: all are destroyed.
  [[nodiscard]] Index live_at(Index node, std::span<const std::uint8_t> destroyed) const;
  /// The element behind a face of the mesh, whether the face is open or not; kNone: there is none.
  [[nodiscard]] Index behind(const Face& face) const {
    return behind_[static_cast<std::size_t>(face.element)][static_cast<std::size_t>(face.opposite)];
  }
  /// The same face as the element behind it has it.
  [[nodiscard]] Face other_side(const Face& face) const;
  [[nodiscard]] bool open(const Face& face) const {
    return (open_[static_cast<std::size_t>(face.element)] >> face.opposite & 1) != 0;
  }
  /// Nodes of a face, by the element's order of corners.
  [[nodiscard]] std::array<Index, 3> nodes(const Face& face) const;

  /// Unknowns that the scene's grips hold from now on, ascending; at first all of them. Nodes do
  /// not part along what is held.
  void hold(std::span<const Index> unknowns) { gripped_.assign(unknowns.begin(), unknowns.end()); }
  /// Never more nodes than this, the mesh's included.
  void allow(Index nodes) { most_nodes_ = nodes; }
  /// Opens faces between two elements and names what changes by it: elements with other corners and
  /// the nodes that come. Elements that are destroyed hold nothing together and keep their corners.
  /// False, and nothing has changed: more nodes would come than are allowed.
  [[nodiscard]] bool open(std::span<const Face> faces, std::span<const std::uint8_t> destroyed,
                          fem::Change& change);
  /// Whether open() would, and changes nothing.
  [[nodiscard]] bool can_open(std::span<const Face> faces, std::span<const std::uint8_t> destroyed);
  /// Whether the live elements at a node hang together by faces that are not open.
  [[nodiscard]] bool whole(Index node, std::span<const std::uint8_t> destroyed) const;

  /// What opening has left, to go back to.
  struct State {
    std::vector<std::array<Index, 4>> corners;
    std::vector<std::uint8_t> open;
    std::vector<std::vector<Index>> at_node;
    std::vector<Index> parents;
  };
  [[nodiscard]] State state() const { return {corners_, open_, at_node_, parents_}; }
  void restore(const State& state) {
    corners_ = state.corners;
    open_ = state.open;
    at_node_ = state.at_node;
    parents_ = state.parents;
  }

 private:
  void find_neighbours();
  [[nodiscard]] std::vector<Index> mark_open(std::span<const Face> faces);
  [[nodiscard]] bool has_room(std::span<const Index> touched,
                              std::span<const std::uint8_t> destroyed) const;
  [[nodiscard]] std::vector<std::vector<Index>> parts_at(
      Index node, std::span<const std::uint8_t> destroyed) const;
  void split(Index node, std::span<const std::uint8_t> destroyed, fem::Change& change);
  [[nodiscard]] std::vector<std::vector<Index>> groups(
      Index node, std::span<const std::uint8_t> destroyed) const;
  [[nodiscard]] Index add_node(Index node, std::span<const Index> group, fem::Change& change);

  [[nodiscard]] Axes free_axes(Index parent) const;

  const Problem& problem_;
  std::vector<Index> gripped_;
  Index most_nodes_ = std::numeric_limits<Index>::max();
  std::vector<std::array<Index, 4>> corners_, behind_;  // per element
  std::vector<std::uint8_t> open_;                      // per element, a bit a face
  std::vector<std::vector<Index>> at_node_;             // elements
  std::vector<Index> parents_;                          // of nodes that were added
};

}  // namespace sunder::fracture
