// SPDX-License-Identifier: Apache-2.0
// The lowest mode of the tangent at a state: whether a body at rest would rather be elsewhere, and
// to which side it goes.
#pragma once

#include <Eigen/Core>

#include "body/tangent_pattern.hpp"
#include "solver/resting_body.hpp"

namespace sunder::solver {

struct LowestMode {
  double stiffness = 0;  ///< the tangent's least eigenvalue [N/mm]; negative: it would leave
  /// Of length 1; its largest component is positive, of several as large the first.
  Eigen::VectorXd shape;
  int factors = 0;
};
/// Gripped and frozen unknowns stay. By inverse iteration on the tangent with a shift that makes it
/// positive definite, from a fixed start.
[[nodiscard]] LowestMode lowest_mode(const RestingBody& body, const std::vector<double>& u,
                                     const fem::TangentPattern& pattern);

}  // namespace sunder::solver
