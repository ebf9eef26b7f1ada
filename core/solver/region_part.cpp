// SPDX-License-Identifier: Apache-2.0
#include "solver/region_part.hpp"

namespace sunder::solver {

RegionPart::RegionPart(const Problem& whole, const Region& region) {
  element_.assign(whole.mesh().tets.size(), kNone);
  std::vector<std::uint8_t> used(whole.mesh().nodes.size(), 0);
  for (Index n : region.nodes) used[n] = 1;
  for (std::size_t i = 0; i < region.elements.size(); ++i) {
    element_[region.elements[i]] = static_cast<Index>(i);
    for (Index n : whole.mesh().tets[region.elements[i]]) used[n] = 1;
  }
  node_.assign(used.size(), kNone);
  for (Index n = 0; n < whole.node_count(); ++n) {
    if (!used[n]) continue;
    node_[n] = static_cast<Index>(part_of_body_.nodes.size());
    part_of_body_.nodes.push_back(n);
  }
  part_of_body_.elements = region.elements;
  part_ = std::make_shared<Problem>(whole, part_of_body_);
}

}  // namespace sunder::solver
