// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/minimum_degree.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <cstdint>

namespace sunder::linear_algebra {

std::vector<Index> minimum_degree_order(Index count,
                                        std::span<const std::pair<Index, Index>> edges) {
  std::vector<Eigen::Triplet<std::int8_t, Index>> entries;
  entries.reserve(edges.size());
  for (const auto& edge : edges) entries.emplace_back(edge.first, edge.second, std::int8_t{1});
  Eigen::SparseMatrix<std::int8_t, Eigen::ColMajor, Index> graph(count, count);
  graph.setFromTriplets(entries.begin(), entries.end(),
                        [](std::int8_t a, std::int8_t) { return a; });
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> order;
  Eigen::AMDOrdering<Index>()(graph, order);
  std::vector<Index> of(static_cast<std::size_t>(count));
  for (Index i = 0; i < count; ++i) of[static_cast<std::size_t>(i)] = order.indices()[i];
  return of;
}

}  // namespace sunder::linear_algebra
