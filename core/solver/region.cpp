// SPDX-License-Identifier: Apache-2.0
#include "solver/region.hpp"

#include <algorithm>

#include "sunder/fracture_model.hpp"

namespace sunder::solver {
namespace {

void mark(const Problem& problem, Index element, std::vector<std::uint8_t>& inside) {
  for (Index n : problem.mesh().tets[element]) inside[n] = 1;
}

void mark_elements(const Problem& problem, const Needs& needs, Region& region) {
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (!problem.destructible(e)) continue;
    mark(problem, e, region.inside);
    region.tears = region.tears || row_of(problem.scene().fracture.model).breaks;
  }
  if (needs.damage) {
    for (const auto* lists : {&problem.crack_elements(), &problem.removal_elements()}) {
      for (const auto& elements : *lists) {
        for (Index e : elements) mark(problem, e, region.inside);
        region.tears = region.tears || !elements.empty();
      }
    }
  }
  if (region.tears || !problem.scene().live) return;
  // Only a host changes it: it may do so anywhere.
  for (Index e = 0; e < problem.tet_count(); ++e) mark(problem, e, region.inside);
  region.tears = true;
}

}  // namespace

Region region_of(const Problem& problem, const Needs& needs, std::span<const Index> beyond) {
  Region region;
  region.inside.assign(problem.mesh().nodes.size(), 0);
  if (needs.damage || needs.yield) mark_elements(problem, needs, region);
  for (Index e : beyond) mark(problem, e, region.inside);
  for (const InstrumentNodes& instrument : problem.instrument_nodes()) {
    for (Index n : instrument.nodes) region.inside[n] = 1;
  }
  for (Index n = 0; n < problem.node_count(); ++n) {
    const std::size_t before = region.dofs.size();
    bool held = true;
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem.dof(n, axis);
      if (d == kNone) continue;
      held = false;
      if (region.inside[n]) region.dofs.push_back(d);
    }
    if (region.dofs.size() > before) region.nodes.push_back(n);
    if (held) region.inside[n] = 1;
  }
  std::sort(region.dofs.begin(), region.dofs.end());
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const auto& tet = problem.mesh().tets[e];
    if (std::all_of(tet.begin(), tet.end(), [&](Index n) { return region.inside[n] != 0; })) {
      region.elements.push_back(e);
    }
  }
  return region;
}

std::vector<std::string> left_out_of(const Problem& problem, const Region& region) {
  const auto all = static_cast<std::size_t>(problem.dof_count());
  return {
      "inverse of the other " + std::to_string(all - region.dofs.size()) +
          " unknowns: they cannot break by themselves and no instrument of the scene holds them",
      "stress of the other " + std::to_string(problem.mesh().tets.size() - region.elements.size()) +
          " elements and displacement of the other nodes in a frame: solved for when a file or "
          "a picture asks",
      "largest strain and rotation of those elements: what is told of them is of the region"};
}

}  // namespace sunder::solver
