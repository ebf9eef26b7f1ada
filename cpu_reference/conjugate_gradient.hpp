// SPDX-License-Identifier: Apache-2.0
// Preconditioned conjugate gradients on the damaged body, preconditioned by the intact one.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace sunder::cpu_reference {

using LinearMap = std::function<void(const Eigen::VectorXd& in, Eigen::VectorXd& out)>;

struct CgResult {
  int iterations = 0;
  bool converged = false;  ///< false: the iteration limit, or rounding stalled it
};

/// When to stop: r^T M r <= max(absolute, relative * b^T M b), M the preconditioner.
struct CgStop {
  double absolute = 0;  ///< [N mm]
  double relative = 0;
  int max_iterations = 2000;
};

/// Solves A x = b from x = 0; the preconditioner M is an approximate inverse of A, symmetric
/// positive definite.
CgResult conjugate_gradient(const LinearMap& a, const LinearMap& preconditioner,
                            const Eigen::VectorXd& b, const CgStop& stop, Eigen::VectorXd& x);

}  // namespace sunder::cpu_reference
