// SPDX-License-Identifier: Apache-2.0
#include "body/hanging_parts.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "body/mesh_findings.hpp"

namespace sunder {
namespace {

class Search {
 public:
  Search(const Mesh& mesh, FaceParts parts, std::span<const std::uint8_t> restrained)
      : mesh_(mesh), parts_(std::move(parts)), restrained_(restrained) {
    find_joints();
    rest_.assign(static_cast<std::size_t>(parts_.count), 1);
    held_.assign(rest_.size(), 0);
    for_corners([&](Index n, Index part) {
      if (restrained[n] && !joints_.contains(n)) held_[part] = 1;
    });
    for (const auto& [node, at] : joints_)
      for (Index part : at) nodes_of_[part].push_back(node);
    elements_.resize(rest_.size());
    for (Index e = 0; e < mesh_.tet_count(); ++e) elements_[parts_.part_of_element[e]].push_back(e);
  }

  std::vector<HangingPart> find() {
    std::vector<HangingPart> hanging;
    for (bool found = true; found;) {
      found = false;
      for (const auto& [part, nodes] : nodes_of_) {
        if (!rest_[part] || held_[part]) continue;
        const std::vector<Index> hinge = hinge_of(part, nodes);
        if (hinge.empty()) continue;
        rest_[part] = 0;
        found = true;
        HangingPart hangs = describe(part, hinge, nodes);
        if (!hangs.latches.empty()) hanging.push_back(std::move(hangs));
      }
    }
    std::sort(hanging.begin(), hanging.end(),
              [](const HangingPart& a, const HangingPart& b) { return a.first < b.first; });
    return hanging;
  }

 private:
  template <class Body>
  void for_corners(Body&& body) const {
    for (Index e = 0; e < mesh_.tet_count(); ++e)
      for (Index n : mesh_.tets[e]) body(n, parts_.part_of_element[e]);
  }

  /// Nodes of several parts, with them.
  void find_joints() {
    std::vector<Index> owner(mesh_.nodes.size(), kNone);
    for_corners([&](Index n, Index part) {
      if (owner[n] == kNone) owner[n] = part;
      if (owner[n] != part) joints_[n].insert({owner[n], part});
    });
  }

  /// Nodes by which a part hangs on the rest; empty when it holds the rest together.
  [[nodiscard]] std::vector<Index> hinge_of(Index part, const std::vector<Index>& nodes) const {
    std::vector<Index> hinge;
    std::set<Index> neighbours;
    for (Index n : nodes) {
      bool any = false;
      for (Index other : joints_.at(n)) {
        if (other == part || !rest_[other]) continue;
        neighbours.insert(other);
        any = true;
      }
      if (any) hinge.push_back(n);
    }
    if (neighbours.size() > 1 && hinge.size() > 1) hinge.clear();
    return hinge;
  }

  [[nodiscard]] HangingPart describe(Index part, std::vector<Index> hinge,
                                     const std::vector<Index>& joints) const {
    for (Index n : joints)  // those of parts that hang on this one may be supports as well
      if (restrained_[n]) hinge.push_back(n);
    const std::vector<Index>& elements = elements_[part];
    HangingPart hangs{static_cast<Index>(elements.size()), elements.front(), {}};
    std::set<Index> nodes;  // a latch on a joint would hold another part as well
    for (Index e : elements) {
      for (Index n : mesh_.tets[e])
        if (!joints_.contains(n)) nodes.insert(n);
    }
    std::vector<fem::HeldDof> held;
    for (Index n : hinge) {
      for (int axis = 0; axis < 3; ++axis) held.push_back({n, axis});
    }
    const std::vector<Index> own(nodes.begin(), nodes.end());
    hangs.latches = fem::missing_supports(mesh_, held, own);
    return hangs;
  }

  const Mesh& mesh_;
  FaceParts parts_;
  std::span<const std::uint8_t> restrained_;
  std::map<Index, std::set<Index>> joints_;
  std::map<Index, std::vector<Index>> nodes_of_;  // joints of a part
  std::vector<std::vector<Index>> elements_;      // of a part
  std::vector<std::uint8_t> rest_;                // per part: not hanging so far
  std::vector<std::uint8_t> held_;                // per part: by something of its own
};

}  // namespace

std::vector<HangingPart> find_hanging_parts(const Mesh& mesh, const fem::Bodies& bodies,
                                            std::span<const std::uint8_t> restrained) {
  FaceParts parts = find_face_parts(mesh);
  if (parts.count == bodies.count) return {};
  return Search(mesh, std::move(parts), restrained).find();
}

}  // namespace sunder
