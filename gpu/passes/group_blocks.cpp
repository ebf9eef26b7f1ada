// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/group_blocks.hpp"

#include <algorithm>

namespace sunder::gpu {

Six& GroupBlocks::at(Index row, Index column) {
  std::vector<Entry>& entries = rows_[static_cast<std::size_t>(row)];
  auto place = std::ranges::lower_bound(entries, column, {}, &Entry::column);
  if (place == entries.end() || place->column != column) {
    place = entries.insert(place, Entry{column, Six::Zero()});
  }
  return place->block;
}

std::size_t GroupBlocks::count() const {
  std::size_t sum = 0;
  for (const auto& entries : rows_) sum += entries.size();
  return sum;
}

Eigen::MatrixXd GroupBlocks::dense() const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(6 * static_cast<Eigen::Index>(rows()), 6 * columns_);
  for (std::size_t r = 0; r < rows(); ++r) {
    for (const Entry& entry : rows_[r]) {
      all.block<6, 6>(6 * static_cast<Eigen::Index>(r), 6 * entry.column) = entry.block;
    }
  }
  return all;
}

GroupBlocks GroupBlocks::transposed() const {
  GroupBlocks other(static_cast<std::size_t>(columns_), static_cast<Index>(rows()));
  for (std::size_t r = 0; r < rows(); ++r) {
    for (const Entry& entry : rows_[r]) {
      other.rows_[static_cast<std::size_t>(entry.column)].push_back(
          {static_cast<Index>(r), entry.block.transpose()});
    }
  }
  return other;
}

GroupBlocks GroupBlocks::times(const GroupBlocks& right) const {
  GroupBlocks product(rows(), right.columns_);
  for (std::size_t r = 0; r < rows(); ++r) {
    for (const Entry& entry : rows_[r]) {
      for (const Entry& of : right.rows_[static_cast<std::size_t>(entry.column)]) {
        product.at(static_cast<Index>(r), of.column).noalias() += entry.block * of.block;
      }
    }
  }
  return product;
}

}  // namespace sunder::gpu
