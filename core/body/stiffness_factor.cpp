// SPDX-License-Identifier: Apache-2.0
#include "body/stiffness_factor.hpp"

#include <array>
#include <vector>

#include "body/assembly.hpp"
#include "body/pools.hpp"
#include "linear_algebra/cell_dissection.hpp"
#include "linear_algebra/nested_dissection.hpp"

namespace sunder::fem {

std::vector<Index> elimination_order(const Problem& problem) {
  std::vector<std::array<Index, 3>> unknowns(static_cast<std::size_t>(problem.node_count()));
  for (Index n = 0; n < problem.node_count(); ++n) {
    for (int axis = 0; axis < 3; ++axis) unknowns[n][axis] = problem.dof(n, axis);
  }
  if (!problem.pools()) {
    return linear_algebra::nested_dissection({problem.mesh().nodes, unknowns, problem.mesh().tets});
  }
  std::vector<std::vector<Index>> cells;
  for (Index p = 0; p < problem.pools()->count(); ++p) {
    cells.push_back(problem.pools()->nodes(problem, p));
  }
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const auto& tet = problem.mesh().tets[static_cast<std::size_t>(e)];
    if (problem.pools()->of(e) == kNone) cells.emplace_back(tet.begin(), tet.end());
  }
  return linear_algebra::cell_dissection({problem.mesh().nodes, unknowns, cells});
}

linear_algebra::Factor factor_stiffness(const Problem& problem, std::span<const double> scale,
                                        const linear_algebra::FactorWork& work) {
  return {assemble_lower(problem, scale), elimination_order(problem), work};
}

linear_algebra::Factor factor_stiffness(const DamagedBody& body,
                                        const linear_algebra::FactorWork& work) {
  return {body.stiffness(), elimination_order(body.problem()), work};
}

}  // namespace sunder::fem
