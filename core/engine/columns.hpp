// SPDX-License-Identifier: Apache-2.0
// The kernel of every frame on a dense base: a sum of some columns.
#pragma once

#include <Eigen/Core>
#include <span>

#include "sunder/types.hpp"

namespace sunder::engine {

/// y += sum of value_i * x.col(column_i). Reads rows(x) doubles for each column; the order of the
/// sum is fixed by the order of the columns alone.
void add_columns(const Eigen::MatrixXd& x, std::span<const Index> columns,
                 std::span<const double> values, Eigen::VectorXd& y);

}  // namespace sunder::engine
