// SPDX-License-Identifier: Apache-2.0
#include "pieces.hpp"

#include <algorithm>

#include "fem/supports.hpp"

namespace sunder {

LooseParts find_loose_parts(const Problem& problem, std::span<const std::uint8_t> destroyed) {
  const fem::Bodies bodies = fem::find_bodies(problem.mesh(), destroyed);
  const auto gripped = problem.gripped_dofs();
  std::vector<std::vector<fem::HeldDof>> held(static_cast<std::size_t>(bodies.count));
  LooseParts parts;
  for (Index n = 0; n < problem.node_count(); ++n) {
    const Index body = bodies.body_of_node[n];
    if (body == kNone) {
      parts.isolated_nodes.push_back(n);
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem.dof(n, axis);
      if (d == kNone || std::binary_search(gripped.begin(), gripped.end(), d)) {
        held[body].push_back({n, axis});
      }
    }
  }
  std::vector<Index> piece_of_body(held.size(), kNone);
  for (Index b = 0; b < bodies.count; ++b) {
    if (fem::rigid_modes_left(problem.mesh(), held[b]) == 0) continue;
    piece_of_body[b] = static_cast<Index>(parts.pieces.size());
    parts.pieces.emplace_back();
  }
  if (parts.pieces.empty()) return parts;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Index body = bodies.body_of_element[e];
    if (body != kNone && piece_of_body[body] != kNone) {
      parts.pieces[piece_of_body[body]].push_back(e);
    }
  }
  return parts;
}

}  // namespace sunder
