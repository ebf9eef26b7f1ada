// SPDX-License-Identifier: Apache-2.0
#include "solver/grown_inverse.hpp"

#include <algorithm>

namespace sunder::solver {
namespace {

constexpr Eigen::Index kRoom = 64;  // further unknowns at first

}  // namespace

GrownInverse::Column GrownInverse::column(Eigen::Index j) const {
  const Eigen::Index n = first_rows();
  return {j < n ? first_->col(j).data() : right_->col(j - n).data(),
          added_ > 0 ? below_->col(j).data() : nullptr, n};
}

void GrownInverse::make_room(Eigen::Index added) {
  const Eigen::Index n = first_rows(), had = right_ ? right_->cols() : 0;
  if (added <= had) return;
  const Eigen::Index room = std::max({kRoom, added, 2 * had});
  auto right = std::make_shared<Eigen::MatrixXd>(n, room),
       below = std::make_shared<Eigen::MatrixXd>(room, n + room);
  if (added_ > 0) {
    right->leftCols(added_) = right_->leftCols(added_);
    below->topLeftCorner(added_, n + added_) = below_->topLeftCorner(added_, n + added_);
  }
  right_ = std::move(right);
  below_ = std::move(below);
}

void GrownInverse::add(const Eigen::MatrixXd& columns) {
  const Eigen::Index n = first_rows(), before = size(), k = columns.cols();
  make_room(added_ + k);
  right_->middleCols(added_, k) = columns.topRows(n);
  below_->block(0, before, added_ + k, k) = columns.bottomRows(added_ + k);
  below_->block(added_, 0, k, before) = columns.topRows(before).transpose();
  added_ += k;
}

std::shared_ptr<const Eigen::MatrixXd> GrownInverse::whole() const {
  if (added_ == 0) return first_;
  const Eigen::Index n = first_rows();
  auto all = std::make_shared<Eigen::MatrixXd>(size(), size());
  all->topLeftCorner(n, n) = *first_;
  all->topRightCorner(n, added_) = right_->leftCols(added_);
  all->bottomRows(added_) = below_->topLeftCorner(added_, size());
  return all;
}

std::size_t GrownInverse::bytes() const {
  Eigen::Index doubles = first_ ? first_->size() : 0;
  if (right_) doubles += right_->size() + below_->size();
  return static_cast<std::size_t>(doubles) * sizeof(double);
}

}  // namespace sunder::solver
