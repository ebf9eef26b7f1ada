// SPDX-License-Identifier: Apache-2.0
// The base of statics at finite deformation: the factor of the tangent of a recent state.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "linear_algebra/factor.hpp"
#include "solver/resting_body.hpp"

namespace sunder::solver {

class FiniteBase {
 public:
  /// Of the tangent at u. Gripped and frozen unknowns have equations of their own. Throws
  /// NumericalError where the tangent is not positive definite.
  FiniteBase(const RestingBody& body, std::vector<double> u, fem::Tangent kind,
             const std::vector<Index>& order);
  /// x = A^-1 b.
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);

 private:
  std::vector<double> u_;
  linear_algebra::Factor factor_;
  linear_algebra::SolveWork work_;
};

}  // namespace sunder::solver
