// SPDX-License-Identifier: Apache-2.0
#include "body/pieces.hpp"

#include <algorithm>

namespace sunder {

LooseSearch::LooseSearch(const Problem& problem)
    : problem_(problem),
      gripped_(problem.gripped_dofs().begin(), problem.gripped_dofs().end()),
      used_(used_nodes(problem.mesh())) {
  unused_ = static_cast<std::size_t>(std::ranges::count(used_, std::uint8_t{0}));
  collect_held();
  const std::size_t most = problem.mesh().nodes.size() / 4;  // bodies
  held_end_.reserve(most + 1);
  piece_of_body_.reserve(most);
}

bool LooseSearch::hold(std::span<const Index> unknowns, std::span<const Index> nodes) {
  const bool others = !std::ranges::equal(unknowns, gripped_);
  if (!others && std::ranges::equal(nodes, also_held_)) return false;
  if (others) {
    gripped_.assign(unknowns.begin(), unknowns.end());
    collect_held();
  }
  also_held_.assign(nodes.begin(), nodes.end());
  all_held_.resize(of_problem_);
  for (Index n : nodes) {
    for (int axis = 0; axis < 3; ++axis) all_held_.push_back({n, axis});
  }
  held_.resize(all_held_.size());
  return true;
}

/// By supports and the problem's grips; the nodes besides, and new ones, come after them.
void LooseSearch::collect_held() {
  all_held_.clear();
  for (Index n = 0; n < problem_.node_count(); ++n) {
    if (!used_[static_cast<std::size_t>(n)]) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem_.dof(n, axis);
      if (d == kNone || std::ranges::binary_search(gripped_, d)) all_held_.push_back({n, axis});
    }
  }
  of_problem_ = all_held_.size();
  held_.resize(of_problem_);
}

/// held_ by body, each in the order of nodes.
void LooseSearch::sort_held() {
  held_end_.assign(static_cast<std::size_t>(bodies_.count) + 1, 0);
  for (const fem::HeldDof& h : all_held_) {
    if (!isolated(h.node)) ++held_end_[static_cast<std::size_t>(bodies_.body_of_node[h.node]) + 1];
  }
  for (std::size_t b = 1; b < held_end_.size(); ++b) held_end_[b] += held_end_[b - 1];
  for (const fem::HeldDof& h : all_held_) {  // each body's begin becomes its end
    if (!isolated(h.node)) {
      held_[held_end_[static_cast<std::size_t>(bodies_.body_of_node[h.node])]++] = h;
    }
  }
}

void LooseSearch::look(std::span<const std::uint8_t> destroyed) {
  search(problem_.mesh(), destroyed);
}

void LooseSearch::look(std::span<const std::uint8_t> destroyed,
                       std::span<const std::array<Index, 4>> corners, Index nodes) {
  if (nodes > problem_.node_count()) follow(corners, nodes);
  search(nodes > problem_.node_count() ? split_ : problem_.mesh(), destroyed);
}

/// New nodes lie where their parents do and are held as those are.
void LooseSearch::follow(std::span<const std::array<Index, 4>> corners, Index nodes) {
  split_.tets.assign(corners.begin(), corners.end());
  split_.nodes = problem_.mesh().nodes;
  split_.nodes.resize(static_cast<std::size_t>(nodes));
  std::vector<Index> parent(static_cast<std::size_t>(nodes), kNone);
  for (std::size_t e = 0; e < corners.size(); ++e) {
    for (std::size_t a = 0; a < 4; ++a) {
      const Index n = corners[e][a], in_mesh = problem_.mesh().tets[e][a];
      if (n == in_mesh) continue;
      parent[static_cast<std::size_t>(n)] = in_mesh;
      split_.nodes[static_cast<std::size_t>(n)] =
          problem_.mesh().nodes[static_cast<std::size_t>(in_mesh)];
    }
  }
  const auto first = static_cast<std::size_t>(problem_.node_count());
  std::erase_if(all_held_, [&](const fem::HeldDof& h) { return h.node >= problem_.node_count(); });
  const std::vector<fem::HeldDof> of_mesh = all_held_;
  for (std::size_t n = first; n < parent.size(); ++n) {
    for (const fem::HeldDof& h : of_mesh) {
      if (h.node == parent[n]) all_held_.push_back({static_cast<Index>(n), h.axis});
    }
  }
  held_.resize(all_held_.size());
  used_.resize(parent.size(), 1);
}

void LooseSearch::search(const Mesh& mesh, std::span<const std::uint8_t> destroyed) {
  fem::find_bodies(mesh, destroyed, bodies_, room_);
  isolated_ = static_cast<std::size_t>(std::ranges::count(bodies_.body_of_node, kNone)) - unused_;
  sort_held();
  pieces_ = cut_off_ = 0;
  piece_of_body_.assign(static_cast<std::size_t>(bodies_.count), kNone);
  std::size_t begin = 0;
  for (std::size_t b = 0; b < piece_of_body_.size(); ++b) {
    const std::span held(held_.data() + begin, held_end_[b] - begin);
    begin = held_end_[b];
    if (fem::rigid_modes_left(mesh, held) == 0) continue;
    piece_of_body_[b] = static_cast<Index>(pieces_++);
  }
  if (pieces_ == 0) return;
  for (Index e = 0; e < problem_.tet_count(); ++e) cut_off_ += piece_of(e) != kNone;
}

LooseParts find_loose_parts(const Problem& problem, std::span<const std::uint8_t> destroyed) {
  return find_loose_parts(problem, destroyed, problem.mesh());
}

LooseParts find_loose_parts(const Problem& problem, std::span<const std::uint8_t> destroyed,
                            const Mesh& body) {
  LooseSearch search(problem);
  search.look(destroyed, body.tets, body.node_count());
  LooseParts parts;
  for (Index n = 0; n < body.node_count(); ++n) {
    if (search.isolated(n)) parts.isolated_nodes.push_back(n);
  }
  parts.pieces.resize(search.pieces());
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Index piece = search.piece_of(e);
    if (piece != kNone) parts.pieces[static_cast<std::size_t>(piece)].push_back(e);
  }
  return parts;
}

}  // namespace sunder
