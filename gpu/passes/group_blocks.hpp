// SPDX-License-Identifier: Apache-2.0
// Sparse matrices between groups of nodes, 6 x 6 a pair: three shifts and three turns of a group.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::gpu {

using Six = Eigen::Matrix<double, 6, 6>;

class GroupBlocks {
 public:
  struct Entry {
    Index column;
    Six block;
  };

  GroupBlocks() = default;
  GroupBlocks(std::size_t rows, Index columns) : rows_(rows), columns_(columns) {}

  /// The block at a place, zero at first. Invalidates references to others of its row.
  Six& at(Index row, Index column);
  [[nodiscard]] const std::vector<Entry>& row(std::size_t row) const { return rows_[row]; }
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  [[nodiscard]] Index columns() const { return columns_; }
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] Eigen::MatrixXd dense() const;
  [[nodiscard]] GroupBlocks transposed() const;
  [[nodiscard]] GroupBlocks times(const GroupBlocks& right) const;

 private:
  std::vector<std::vector<Entry>> rows_;  // columns ascending
  Index columns_ = 0;
};

}  // namespace sunder::gpu
