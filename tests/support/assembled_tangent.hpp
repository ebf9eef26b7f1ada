// SPDX-License-Identifier: Apache-2.0
// The tangent of a body as one writes it down: element by element, in the order of the unknowns.
#pragma once

#include <vector>

#include "body/assembly.hpp"
#include "body/hyperelastic.hpp"
#include "body/pooled_law.hpp"

namespace sunder::test {

/// df/du, lower triangle only, anchors included. Unknowns that no live element reaches are frozen:
/// 1 N/mm on the diagonal.
inline linear_algebra::SparseMatrix assemble_tangent(const fem::HyperelasticBody& body,
                                                     std::span<const double> u, fem::Tangent kind) {
  linear_algebra::SparseMatrix lower =
      fem::assemble_elements(body.problem, [&](Index e) -> fem::ElementMatrix {
        return body.live(e) ? fem::element_tangent(body, e, u, kind) : fem::ElementMatrix::Zero();
      });
  std::vector<Eigen::Triplet<double, Index>> of_patches;
  const fem::PatchVolumes volumes(body, u);
  for (std::size_t p = 0; p < volumes.stiffness().size(); ++p) {
    const auto patch =
        fem::patch_tangent(body, static_cast<Index>(p), u, volumes.stiffness()[p], kind);
    const auto nodes = body.pools()->nodes(body.problem, static_cast<Index>(p));
    for (Eigen::Index j = 0; j < patch.b.size(); ++j) {
      for (Eigen::Index i = 0; i < patch.b.size(); ++i) {
        const Index row = body.problem.dof(nodes[static_cast<std::size_t>(i / 3)], i % 3),
                    column = body.problem.dof(nodes[static_cast<std::size_t>(j / 3)], j % 3);
        if (column == kNone || row < column) continue;
        of_patches.emplace_back(row, column, patch.factor * patch.b[i] * patch.b[j]);
      }
    }
  }
  linear_algebra::SparseMatrix pressure(lower.rows(), lower.cols());
  pressure.setFromTriplets(of_patches.begin(), of_patches.end());
  lower += pressure;
  for (Index d = 0; d < lower.cols(); ++d) {
    if (lower.coeff(d, d) == 0) lower.coeffRef(d, d) = 1;
  }
  return lower;
}

}  // namespace sunder::test
