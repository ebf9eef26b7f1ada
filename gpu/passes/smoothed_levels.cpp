// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/smoothed_levels.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace sunder::gpu {
namespace {

// Added to a diagonal, in shares of its largest entry: motions that supports take away leave zeros
// there.
constexpr double kShift = 1e-13;
// Eigenvalues of a diagonal block under this share of its largest are such zeros.
constexpr double kNothing = 1e-10;
// Of the power iteration; w has room for a third that it lacks.
constexpr int kPowerSteps = 20;

Six inverse_where_positive(const Six& block) {
  const Eigen::SelfAdjointEigenSolver<Six> solver(block);
  const double least = kNothing * solver.eigenvalues().maxCoeff();
  Six sum = Six::Zero();
  for (int k = 0; k < 6; ++k) {
    const double value = solver.eigenvalues()[k];
    const auto vector = solver.eigenvectors().col(k);
    if (value > least && value > 0) sum += vector * vector.transpose() / value;
  }
  return sum;
}

std::vector<Six> inverses_of_diagonal(const GroupBlocks& k) {
  std::vector<Six> all;
  for (std::size_t r = 0; r < k.rows(); ++r) {
    Six inverse = Six::Zero();
    for (const GroupBlocks::Entry& entry : k.row(r)) {
      if (entry.column == static_cast<Index>(r)) inverse = inverse_where_positive(entry.block);
    }
    all.push_back(inverse);
  }
  return all;
}

using Vector6 = Eigen::Matrix<double, 6, 1>;

double largest_eigenvalue(const GroupBlocks& k, const std::vector<Six>& j) {
  std::vector<Vector6> v(k.rows()), next(k.rows());
  // No motion of the whole, and no pattern that K might favour: multiples of the golden ratio.
  double phase = 0;
  for (Vector6& of : v) {
    for (double& value : of) value = (phase = std::fmod(phase + 0.6180339887498949, 1.0)) - 0.5;
  }
  double size = 0;
  for (int step = 0; step < kPowerSteps; ++step) {
    double before = 0, after = 0;
    for (std::size_t r = 0; r < k.rows(); ++r) {
      Vector6 sum = Vector6::Zero();
      for (const GroupBlocks::Entry& entry : k.row(r)) {
        sum += entry.block * v[static_cast<std::size_t>(entry.column)];
      }
      next[r] = j[r] * sum;
      before += v[r].squaredNorm();
      after += next[r].squaredNorm();
    }
    if (!(after > 0)) return size;
    size = std::sqrt(after / before);
    for (std::size_t r = 0; r < k.rows(); ++r) v[r] = next[r] / std::sqrt(after);
  }
  return size;
}

/// (I - w J K) m.
GroupBlocks smoothed(const GroupBlocks& k, const std::vector<Six>& j, double w,
                     const GroupBlocks& m) {
  const GroupBlocks of_k = k.times(m);
  GroupBlocks result = m;
  for (std::size_t r = 0; r < k.rows(); ++r) {
    for (const GroupBlocks::Entry& entry : of_k.row(r)) {
      result.at(static_cast<Index>(r), entry.column).noalias() -= w * j[r] * entry.block;
    }
  }
  return result;
}

/// left^T right.
Eigen::MatrixXd transposed_product(const GroupBlocks& left, const GroupBlocks& right) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(6 * left.columns(), 6 * right.columns());
  for (std::size_t r = 0; r < left.rows(); ++r) {
    for (const GroupBlocks::Entry& a : left.row(r)) {
      for (const GroupBlocks::Entry& b : right.row(r)) {
        sum.block<6, 6>(6 * a.column, 6 * b.column).noalias() += a.block.transpose() * b.block;
      }
    }
  }
  return sum;
}

}  // namespace

Eigen::MatrixXd inverse_of_positive(Eigen::MatrixXd matrix) {
  if (matrix.rows() == 0) return {};
  matrix.diagonal().array() += kShift * matrix.diagonal().maxCoeff();
  const Eigen::LLT<Eigen::MatrixXd> llt(matrix);
  if (llt.info() != Eigen::Success || !llt.matrixLLT().allFinite()) return {};
  return llt.solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.rows()));
}

SmoothedLevels smoothed_levels(const GroupBlocks& stiffness, const GroupBlocks& motions) {
  const std::vector<Six> j = inverses_of_diagonal(stiffness);
  const double largest = largest_eigenvalue(stiffness, j);
  const double w = largest > 0 ? 4 / (3 * largest) : 1;
  SmoothedLevels levels;
  levels.smoother = GroupBlocks(stiffness.rows(), stiffness.columns());
  for (std::size_t r = 0; r < stiffness.rows(); ++r) {
    const auto row = static_cast<Index>(r);
    levels.smoother.at(row, row) = 2 * w * j[r];
    for (const GroupBlocks::Entry& entry : stiffness.row(r)) {
      levels.smoother.at(row, entry.column).noalias() -=
          w * w * j[r] * entry.block * j[static_cast<std::size_t>(entry.column)];
    }
  }
  const GroupBlocks p = smoothed(stiffness, j, w, motions);
  levels.inverse = inverse_of_positive(transposed_product(p, stiffness.times(p)));
  levels.prolongation = smoothed(stiffness, j, w, p);
  return levels;
}

}  // namespace sunder::gpu
