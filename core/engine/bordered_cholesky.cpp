// SPDX-License-Identifier: Apache-2.0
#include "engine/bordered_cholesky.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace sunder::engine {

bool BorderedCholesky::append(const Eigen::MatrixXd& border, const Eigen::MatrixXd& block) {
  const Eigen::Index k = block.rows();
  Eigen::MatrixXd y = border;  // L^-1 B; its transpose is the new rows
  solve_lower(y);
  const Eigen::MatrixXd schur = block - y.transpose() * y;
  const Eigen::LLT<Eigen::MatrixXd> llt(schur);
  if (llt.info() != Eigen::Success || !llt.matrixLLT().allFinite() || !y.allFinite()) return false;
  if (size_ + k > l_.rows()) {
    const Eigen::Index room = std::max<Eigen::Index>(size_ + k, 2 * l_.rows());
    l_.conservativeResize(room, room);
  }
  l_.block(size_, 0, k, size_) = y.transpose();
  l_.block(size_, size_, k, k) = llt.matrixL();
  size_ += k;
  return true;
}

void BorderedCholesky::solve_lower(Eigen::Ref<Eigen::MatrixXd> x) const {
  if (size_ == 0) return;
  l_.topLeftCorner(size_, size_).triangularView<Eigen::Lower>().solveInPlace(x);
}

void BorderedCholesky::solve_lower_from(Eigen::Index solved, Eigen::Ref<Eigen::MatrixXd> x) const {
  const Eigen::Index k = size_ - solved;
  if (k == 0) return;
  auto tail = x.bottomRows(k);
  tail.noalias() -= l_.block(solved, 0, k, solved) * x.topRows(solved);
  l_.block(solved, solved, k, k).triangularView<Eigen::Lower>().solveInPlace(tail);
}

void BorderedCholesky::solve_upper(Eigen::Ref<Eigen::MatrixXd> x) const {
  if (size_ == 0) return;
  l_.topLeftCorner(size_, size_).transpose().triangularView<Eigen::Upper>().solveInPlace(x);
}

}  // namespace sunder::engine
