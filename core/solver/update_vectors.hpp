// SPDX-License-Identifier: Apache-2.0
// The update vectors of an event with as few columns as its rank.
#pragma once

#include <vector>

#include "body/event_factor.hpp"

namespace sunder::solver {

/// W' with W' W'^T = W W^T to rounding: a connected event of 100 elements has rank 170-200 instead
/// of 600 columns. Pivoted Cholesky of W W^T, scaled to unit diagonal so that soft elements beside
/// stiff ones keep their digits. Cost rows^2 rank flops.
[[nodiscard]] fem::EventFactor compressed(fem::EventFactor event);

/// Lists that compress() works in; it allocates only until they have grown.
struct CompressRoom {
  std::vector<double> product, v, scaled, scale, left;
  std::vector<Eigen::Index> entries;
  /// For events that touch so many unknowns.
  void reserve(std::size_t rows);
};
/// The same of W (rows x columns) by columns in `w`; returns how many columns there are now.
[[nodiscard]] Eigen::Index compress(Eigen::Index rows, Eigen::Index columns, std::vector<double>& w,
                                    CompressRoom& room);

}  // namespace sunder::solver
