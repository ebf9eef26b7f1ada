// SPDX-License-Identifier: Apache-2.0
// The sparse matrix that is factored: by columns, indices of type Index.
#pragma once

#include <Eigen/SparseCore>

#include "sunder/types.hpp"

namespace sunder::linear_algebra {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

}  // namespace sunder::linear_algebra
