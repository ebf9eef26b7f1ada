// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/node_groups.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "body/supports.hpp"
#include "gpu/passes/bisection.hpp"

namespace sunder::gpu {
namespace {

// Nodes of a group: few, while their equations are few. Iterations of boards of 1,944, 7,776,
// 30,246, 119,286 and 1,003,686 tetrahedra: 132, 102, 95, 121 and 163, where groups of 64 nodes, 64
// at most or 512 of the last two, take 317, 124, 156, 171 and 343.
constexpr Index kNodesPerGroup = 16, kManyGroups = 1024, kNodesOfManyGroups = 32;
// Where groups are kept apart: of the 1944-element board's steps in motion 64, 24 and 10 take 746,
// 407 and 140 ms on lavapipe.
constexpr Index kNodesPerGroupApart = 10;
constexpr Index kFewestNodes = 4;  // of a piece worth a group: below, D alone is exact enough

}  // namespace

Index wanted_groups(Index nodes) {
  return std::max({nodes / kNodesOfManyGroups, std::min(nodes / kNodesPerGroup, kManyGroups), 1});
}

NodeGroups::NodeGroups(const Problem& problem, Index most, Index most_pieces, bool apart)
    : problem_(problem),
      most_(most),
      most_pieces_(most_pieces),
      of_node_(problem.mesh().nodes.size(), kNone) {
  if (apart) kind_ = kinds_of_nodes();
}

/// A node's is the stiffest of its elements', by the shear modulus.
std::vector<Index> NodeGroups::kinds_of_nodes() const {
  std::vector<double> stiffest(problem_.mesh().nodes.size(), 0.0);
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    for (Index n : problem_.mesh().tets[e]) {
      stiffest[n] = std::max(stiffest[n], problem_.small_strain(e).mu);
    }
  }
  std::vector<Index> kinds;
  for (const double mu : stiffest) kinds.push_back(mu > 0 ? std::ilogb(mu) : 0);
  return kinds;
}

NodeGroups::Lists NodeGroups::pieces(std::span<const std::uint8_t> destroyed) const {
  const auto bodies = fem::find_bodies(problem_.mesh(), destroyed);
  Lists nodes(static_cast<std::size_t>(bodies.count));
  for (Index n = 0; n < problem_.node_count(); ++n) {
    const Index body = bodies.body_of_node[n];
    if (body != kNone) nodes[body].push_back(n);
  }
  std::stable_sort(nodes.begin(), nodes.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::erase_if(nodes, [](const auto& body) { return body.size() < kFewestNodes; });
  return nodes;
}

bool NodeGroups::are_of(const Lists& pieces) const {
  std::vector<std::size_t> piece_of_group;
  for (std::size_t p = 0; p < of_pieces_.size(); ++p) {
    piece_of_group.insert(piece_of_group.end(), of_pieces_[p], p);
  }
  const std::size_t none = of_pieces_.size();  // for which there was no room
  const auto before = [&](Index node) {
    const Index g = of(node);
    return g == kNone ? none : piece_of_group[static_cast<std::size_t>(g)];
  };
  std::vector<bool> found(none + 1, false);
  for (const auto& piece : pieces) {
    const std::size_t was = before(piece.front());
    if (!std::ranges::all_of(piece, [&](Index n) { return before(n) == was; })) return false;
    if (was == none ? pieces_ <= none : found[was]) return false;
    found[was] = true;
  }
  return true;
}

bool NodeGroups::make(Lists pieces) {
  pieces_ = pieces.size();
  of_pieces_.clear();
  Lists groups;
  pieces.resize(std::min(pieces.size(), static_cast<std::size_t>(most_pieces_)));
  const Index others = std::max(static_cast<Index>(pieces.size()), 1) - 1;
  std::size_t total = 0;
  for (const auto& piece : pieces) total += piece.size();
  const Index wanted = std::min(wanted_groups(static_cast<Index>(total)), most_ - others);
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const std::size_t before = groups.size();
    if (!kind_.empty()) {
      add_by_kind(pieces[p], p == 0 ? most_ - others : 1, groups);
    } else {
      const Index share = share_of(wanted, pieces[p].size(), total);
      bisect(pieces[p], share, kFewestNodes, problem_.mesh().nodes, groups);
    }
    of_pieces_.push_back(groups.size() - before);
  }
  if (groups == groups_) return false;
  groups_ = std::move(groups);
  std::ranges::fill(of_node_, kNone);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    for (Index n : groups_[g]) of_node_[static_cast<std::size_t>(n)] = static_cast<Index>(g);
  }
  return true;
}

void NodeGroups::add_by_kind(const std::vector<Index>& nodes, Index most, Lists& groups) const {
  std::map<Index, std::vector<Index>> by_kind;
  for (Index n : nodes) by_kind[most > 1 ? kind_[n] : 0].push_back(n);
  const auto spare = std::max<Index>(most - static_cast<Index>(by_kind.size()), 0);
  for (auto& [kind, list] : by_kind) {
    const auto share = static_cast<Index>(spare * list.size() / nodes.size());
    bisect(list,
           std::min(std::max<Index>(static_cast<Index>(list.size()) / kNodesPerGroupApart, 1),
                    1 + share),
           kFewestNodes, problem_.mesh().nodes, groups);
  }
}

}  // namespace sunder::gpu
