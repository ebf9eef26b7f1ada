// SPDX-License-Identifier: Apache-2.0
#include "fracture/split/split_body.hpp"

#include <algorithm>
#include <utility>

namespace sunder::fracture {
/// Axes on which a node can move by itself: neither a support nor a grip holds its parent there.
Axes SplitBody::free_axes(Index parent) const {
  Axes axes{0};
  for (int axis = 0; axis < 3; ++axis) {
    const Index dof = problem_.dof(parent, axis);
    if (dof == kNone || std::ranges::binary_search(gripped_, dof)) continue;
    axes.bits = static_cast<std::uint8_t>(axes.bits | 1U << axis);
  }
  return axes;
}

SplitBody::SplitBody(const Problem& problem)
    : problem_(problem),
      gripped_(problem.gripped_dofs().begin(), problem.gripped_dofs().end()),
      corners_(problem.mesh().tets.begin(), problem.mesh().tets.end()),
      behind_(corners_.size(), {kNone, kNone, kNone, kNone}),
      open_(corners_.size(), 0),
      at_node_(problem.mesh().nodes.size()) {
  for (Index e = 0; e < problem.tet_count(); ++e) {
    for (Index n : corners(e)) at_node_[static_cast<std::size_t>(n)].push_back(e);
  }
  find_neighbours();
}

void SplitBody::find_neighbours() {
  std::vector<std::pair<std::array<Index, 3>, Face>> faces;
  faces.reserve(4 * corners_.size());
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    for (int i = 0; i < 4; ++i) {
      std::array<Index, 3> face = nodes({e, i});
      std::sort(face.begin(), face.end());
      faces.push_back({face, {e, i}});
    }
  }
  std::sort(faces.begin(), faces.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second.element < b.second.element;
  });
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].first != faces[i - 1].first) continue;
    const Face a = faces[i - 1].second, b = faces[i].second;
    behind_[static_cast<std::size_t>(a.element)][static_cast<std::size_t>(a.opposite)] = b.element;
    behind_[static_cast<std::size_t>(b.element)][static_cast<std::size_t>(b.opposite)] = a.element;
  }
}

Face SplitBody::other_side(const Face& face) const {
  const Index other = behind(face);
  const auto& around = behind_[static_cast<std::size_t>(other)];
  return {other, static_cast<int>(std::ranges::find(around, face.element) - around.begin())};
}

std::array<Index, 3> SplitBody::nodes(const Face& face) const {
  std::array<Index, 3> nodes{};
  for (std::size_t a = 0, i = 0; a < 4; ++a) {
    if (static_cast<int>(a) != face.opposite) nodes[i++] = corners(face.element)[a];
  }
  return nodes;
}

/// Marks faces as open; returns the nodes at which something may part by it.
std::vector<Index> SplitBody::mark_open(std::span<const Face> faces) {
  std::vector<Index> touched;
  for (const Face& face : faces) {
    for (Index n : nodes(face)) touched.push_back(n);
    for (const Face& side : {face, other_side(face)}) {
      std::uint8_t& of = open_[static_cast<std::size_t>(side.element)];
      of = static_cast<std::uint8_t>(of | 1U << side.opposite);
    }
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  return touched;
}

/// What parts at one node does not depend on the others.
bool SplitBody::has_room(std::span<const Index> touched,
                         std::span<const std::uint8_t> destroyed) const {
  std::size_t come = 0;
  for (Index n : touched) come += std::max<std::size_t>(parts_at(n, destroyed).size(), 1) - 1;
  return come <= static_cast<std::size_t>(std::max<Index>(most_nodes_ - node_count(), 0));
}

bool SplitBody::can_open(std::span<const Face> faces, std::span<const std::uint8_t> destroyed) {
  const auto before = open_;
  const bool room = has_room(mark_open(faces), destroyed);
  open_ = before;
  return room;
}

bool SplitBody::open(std::span<const Face> faces, std::span<const std::uint8_t> destroyed,
                     fem::Change& change) {
  const auto before = open_;
  const std::vector<Index> touched = mark_open(faces);
  if (!has_room(touched, destroyed)) {
    open_ = before;
    return false;
  }
  for (Index n : touched) split(n, destroyed, change);
  return true;
}

Index SplitBody::live_at(Index node, std::span<const std::uint8_t> destroyed) const {
  const auto star = elements_of(node);
  const auto live = std::ranges::find_if(star, [&](Index e) { return destroyed[e] == 0; });
  return live == star.end() ? kNone : *live;
}

bool SplitBody::whole(Index node, std::span<const std::uint8_t> destroyed) const {
  return groups(node, destroyed).size() < 2;
}

/// Live elements at a node that hang together by faces there, by their first ones.
std::vector<std::vector<Index>> SplitBody::groups(Index node,
                                                  std::span<const std::uint8_t> destroyed) const {
  const auto star = elements_of(node);
  std::vector<std::uint8_t> seen(star.size(), 0);
  const auto place = [&](Index e) {
    const auto at = std::ranges::lower_bound(star, e);
    return at != star.end() && *at == e ? at - star.begin() : std::ptrdiff_t{-1};
  };
  std::vector<std::vector<Index>> groups;
  for (std::size_t s = 0; s < star.size(); ++s) {
    if (seen[s] || destroyed[static_cast<std::size_t>(star[s])]) continue;
    std::vector<Index> group{star[s]};
    seen[s] = 1;
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (int f = 0; f < 4; ++f) {
        const Face face{group[i], f};
        const Index next = behind(face);
        if (next == kNone || open(face) || destroyed[static_cast<std::size_t>(next)]) continue;
        if (corners(group[i])[static_cast<std::size_t>(f)] == node) continue;  // not at the node
        const std::ptrdiff_t at = place(next);
        if (at < 0 || seen[static_cast<std::size_t>(at)]) continue;
        seen[static_cast<std::size_t>(at)] = 1;
        group.push_back(next);
      }
    }
    std::sort(group.begin(), group.end());
    groups.push_back(std::move(group));
  }
  return groups;
}

/// Groups that get nodes of their own, or keep the one that they share.
std::vector<std::vector<Index>> SplitBody::parts_at(Index node,
                                                    std::span<const std::uint8_t> destroyed) const {
  if (free_axes(in_mesh(node)).bits == 0) return {};  // held, whoever's it is
  return groups(node, destroyed);
}

/// The stiffest group keeps the node (method.md 16); of equals the one with the first element.
void SplitBody::split(Index node, std::span<const std::uint8_t> destroyed, fem::Change& change) {
  auto parts = parts_at(node, destroyed);
  if (parts.size() < 2) return;
  const auto stiffness = [this](const std::vector<Index>& group) {
    double most = 0;
    for (Index e : group) most = std::max(most, problem_.small_strain(e).young);
    return most;
  };
  std::size_t keeps = 0;
  for (std::size_t g = 1; g < parts.size(); ++g) {
    if (stiffness(parts[g]) > stiffness(parts[keeps])) keeps = g;
  }
  for (std::size_t g = 0; g < parts.size(); ++g) {
    if (g == keeps) continue;
    const Index added = add_node(node, parts[g], change);
    std::erase_if(at_node_[static_cast<std::size_t>(node)],
                  [&](Index e) { return std::binary_search(parts[g].begin(), parts[g].end(), e); });
    at_node_[static_cast<std::size_t>(added)] = std::move(parts[g]);
  }
}

/// Gives a group of elements a node of their own in place of one that they shared.
Index SplitBody::add_node(Index node, std::span<const Index> group, fem::Change& change) {
  const Index added = node_count(), parent = in_mesh(node);
  parents_.push_back(parent);
  at_node_.emplace_back();
  change.nodes.push_back({parent, free_axes(parent), 0});
  for (Index e : group) {
    auto& own = corners_[static_cast<std::size_t>(e)];
    std::ranges::replace(own, node, added);
    const auto came = std::ranges::find(change.come, e, &fem::Coming::element);
    if (came != change.come.end()) {
      came->form.corners = own;
      continue;
    }
    fem::Form form = fem::form_in_mesh(problem_, e);
    form.corners = own;
    change.come.push_back({e, form});
  }
  return added;
}

}  // namespace sunder::fracture
