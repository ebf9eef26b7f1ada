// SPDX-License-Identifier: Apache-2.0
// A symmetric matrix times a vector, compiled for the vector width at hand. Such a product takes
// the time in which the matrix is read, of which this reads one half.
#pragma once

#include <Eigen/Core>

namespace sunder::linear_algebra {

/// y = S x, n x n. S lies row by row, `stride` apart, and its lower triangle alone is read. The
/// order of all sums is fixed, so the bits do not depend on the vector width.
void symmetric_product(const double* s, Eigen::Index stride, Eigen::Index n, const double* x,
                       double* y);

}  // namespace sunder::linear_algebra
