// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/low_rank.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "linear_algebra/row_product.hpp"

namespace sunder::cpu_reference {
namespace {

// Columns of X that get their share together: they stay in the cache until it is added.
constexpr Eigen::Index kColumns = 16;

/// Rows are processed in full vectors.
Eigen::Index padded(Eigen::Index n) { return (n + 7) / 8 * 8; }

/// At least so many values; what they are does not matter.
double* room(std::vector<double>& v, Eigen::Index rows, Eigen::Index columns) {
  v.resize(std::max(v.size(), static_cast<std::size_t>(rows * columns)));
  return v.data();
}

}  // namespace

InverseUpdate::InverseUpdate(Eigen::Index unknowns) {
  const auto n = static_cast<std::size_t>(padded(unknowns));
  constexpr std::size_t kWidth = 6 * kElements, kMost = 12 * kElements;
  const std::size_t touched = std::min(n, kMost);
  dofs_.reserve(kMost);
  w_.reserve(touched * kWidth);
  columns_.reserve(touched * n);
  z_.reserve(kWidth * n);
  at_event_.reserve(touched * kWidth);
  c_.reserve(kWidth * kWidth);
  product_.reserve(std::max<std::size_t>(kWidth, kColumns) * n);
}

void InverseUpdate::gather(const Problem& problem, std::span<const Index> elements) {
  rank_ = 6 * static_cast<Eigen::Index>(elements.size());
  width_ = padded(rank_);
  fem::event_factor(problem, elements, width_, dofs_, w_);
}

bool InverseUpdate::apply(Eigen::MatrixXd& x) {
  if (dofs_.empty()) return true;  // every corner is held: nothing changes
  const Eigen::Index n = x.rows(), stride = padded(n);
  const auto touched = static_cast<Eigen::Index>(dofs_.size());
  double* columns = room(columns_, touched, stride);
  for (Eigen::Index i = 0; i < touched; ++i) {
    std::copy_n(x.col(dofs_[static_cast<std::size_t>(i)]).data(), n, columns + i * stride);
    std::fill_n(columns + i * stride + n, stride - n, 0.0);
  }
  double* z = room(z_, width_, stride);  // W^T X: X is symmetric
  linear_algebra::row_product({w_.data(), width_, touched, 1, width_}, columns, stride, stride, z,
                              stride);
  if (!factor_c(stride)) return false;
  linear_algebra::lower_solve(c_.data(), width_, width_, z, stride, stride,
                              room(product_, width_, stride));
  for (Eigen::Index i = 0; i < width_; ++i) {
    if (!Eigen::Map<const Eigen::VectorXd>(z + i * stride, n).allFinite()) return false;
  }
  add_product(stride, x);
  return true;
}

/// L of C = I - W^T X W.
bool InverseUpdate::factor_c(Eigen::Index stride) {
  const auto touched = static_cast<Eigen::Index>(dofs_.size());
  double* at_event = room(at_event_, touched, width_);
  for (Eigen::Index i = 0; i < touched; ++i) {
    const double* from = z_.data() + dofs_[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < width_; ++j) at_event[i * width_ + j] = from[j * stride];
  }
  Eigen::Map<Eigen::MatrixXd> c(room(c_, width_, width_), width_, width_);
  linear_algebra::row_product({at_event, width_, touched, 1, width_}, w_.data(), width_, width_,
                              c.data(), width_);
  c = -c;
  c.diagonal().array() += 1;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(c);
  return llt.info() == Eigen::Success && c.diagonal().allFinite();
}

/// X += Z Z^T.
void InverseUpdate::add_product(Eigen::Index stride, Eigen::MatrixXd& x) {
  const Eigen::Index n = x.rows();
  double* product = room(product_, kColumns, stride);
  for (Eigen::Index begin = 0; begin < n; begin += kColumns) {
    const Eigen::Index count = std::min(kColumns, n - begin);
    linear_algebra::row_product({z_.data() + begin, count, rank_, 1, stride}, z_.data(), stride,
                                stride, product, stride);
    for (Eigen::Index j = 0; j < count; ++j) {
      x.col(begin + j) += Eigen::Map<const Eigen::VectorXd>(product + j * stride, n);
    }
  }
}

std::size_t InverseUpdate::bytes() const {
  return (w_.size() + columns_.size() + z_.size() + at_event_.size() + c_.size() +
          product_.size()) *
         sizeof(double);
}

}  // namespace sunder::cpu_reference
