// SPDX-License-Identifier: Apache-2.0
// Products with a vector, compiled for the vector width at hand.
#pragma once

#include <Eigen/Core>
#include <span>

#include "sunder/types.hpp"

namespace sunder::solver {

/// y += sum of value_i * x.col(column_i). Reads rows(x) doubles for each column; the order of the
/// sum is fixed by the order of the columns alone.
void add_columns(const Eigen::MatrixXd& x, std::span<const Index> columns,
                 std::span<const double> values, Eigen::VectorXd& y);

/// The same of columns that begin anywhere, so many rows each.
void add_columns(std::span<const double* const> columns, std::span<const double> values,
                 Eigen::Index rows, double* y);

/// y += V c; V has `rows` rows, its columns begin `stride` apart.
void add_product(const double* v, Eigen::Index stride, Eigen::Index rows, const double* c,
                 Eigen::Index columns, double* y);

}  // namespace sunder::solver
