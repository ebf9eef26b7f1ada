// SPDX-License-Identifier: Apache-2.0
// The tangent of a body as one writes it down: element by element, in the order of the unknowns.
#pragma once

#include "body/assembly.hpp"
#include "body/hyperelastic.hpp"

namespace sunder::test {

/// df/du, lower triangle only, anchors included. Unknowns that no live element reaches are frozen:
/// 1 N/mm on the diagonal.
inline linear_algebra::SparseMatrix assemble_tangent(const fem::HyperelasticBody& body,
                                                     std::span<const double> u, fem::Tangent kind) {
  linear_algebra::SparseMatrix lower =
      fem::assemble_elements(body.problem, [&](Index e) -> fem::ElementMatrix {
        return body.live(e) ? fem::element_tangent(body, e, u, kind) : fem::ElementMatrix::Zero();
      });
  for (Index d = 0; d < lower.cols(); ++d) {
    if (lower.coeff(d, d) == 0) lower.coeffRef(d, d) = 1;
  }
  return lower;
}

}  // namespace sunder::test
