// SPDX-License-Identifier: Apache-2.0
#include "body/node_elements.hpp"

namespace sunder {

NodeElements::NodeElements(const Mesh& mesh)
    : begin_(mesh.nodes.size() + 1, 0), elements_(4 * mesh.tets.size()) {
  for (const auto& tet : mesh.tets)
    for (Index n : tet) ++begin_[n + 1];
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) begin_[n + 1] += begin_[n];
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (Index e = 0; e < mesh.tet_count(); ++e)
    for (Index n : mesh.tets[e]) elements_[next[n]++] = e;
}

}  // namespace sunder
