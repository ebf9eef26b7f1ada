// SPDX-License-Identifier: Apache-2.0
// Eager low-rank update of a dense inverse (method.md "Elasticity" 3).
#pragma once

#include <Eigen/Core>

#include "fem/event_factor.hpp"

namespace sunder::cpu_reference {

/// X <- X + Z Z^T with Z = X W L^-T, L L^T = C = I - W^T X W: the inverse after the event. Returns
/// false and leaves X alone when C is not positive definite in double precision. Cost 12 k n^2
/// flops.
[[nodiscard]] bool update_inverse(const fem::EventFactor& event, Eigen::MatrixXd& x);

}  // namespace sunder::cpu_reference
