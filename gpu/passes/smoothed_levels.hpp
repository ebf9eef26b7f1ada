// SPDX-License-Identifier: Apache-2.0
// Two levels over groups of nodes that stand for the inverse of their stiffness K where it is too
// large for a dense one: a V-cycle of smoothed aggregation (Vanek, Mandel and Brezina, Computing
// 56, 1996) with one damped block-Jacobi step before and after. Written out it is a sum of
// products,
//   B = S + Q A^-1 Q^T,   S = w J (2 I - w K J),   P = (I - w J K) Z,   Q = (I - w J K) P,   A =
//   P^T K P,
// with J the inverse of K's diagonal blocks, w = 4/(3 lambda_max(J K)) and Z the rigid motions of
// aggregates of groups. Symmetric and positive whatever has happened to K since.
#pragma once

#include <Eigen/Core>

#include "gpu/passes/group_blocks.hpp"

namespace sunder::gpu {

struct SmoothedLevels {
  GroupBlocks smoother;      ///< S
  GroupBlocks prolongation;  ///< Q
  Eigen::MatrixXd inverse;   ///< A^-1; of size 0 where A is not positive definite in rounding
};

/// Of a stiffness and of Z, at most a block a row of the last.
[[nodiscard]] SmoothedLevels smoothed_levels(const GroupBlocks& stiffness,
                                             const GroupBlocks& motions);

/// Of a matrix that is singular where supports hold a motion: shifted by a share of its largest
/// entry. Of size 0 where it is not positive definite in rounding.
[[nodiscard]] Eigen::MatrixXd inverse_of_positive(Eigen::MatrixXd matrix);

}  // namespace sunder::gpu
