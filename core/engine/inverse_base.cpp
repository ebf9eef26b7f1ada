// SPDX-License-Identifier: Apache-2.0
#include "engine/inverse_base.hpp"

#include <algorithm>
#include <numeric>

#include "engine/columns.hpp"

namespace sunder::engine {

InverseBase::InverseBase(const fem::Factor& factor)
    : factor_(factor), touched_(factor.cholesky().size()) {
  std::vector<Index> all(static_cast<std::size_t>(factor.cholesky().size()));
  std::iota(all.begin(), all.end(), 0);
  // Not made symmetric: each column as solved is good to 1e-12 of stress, the mean of column and
  // row to 3e-11.
  x_ = factor.inverse_columns(all);
}

Eigen::MatrixXd InverseBase::push(const fem::EventFactor& block) {
  Block added{touched_.push(block.dofs), block.w};
  // X_T,new W_new over all touched rows, from the columns of the new unknowns.
  const auto rows = touched_.list();
  Eigen::MatrixXd x(touched_.size(), static_cast<Index>(block.dofs.size()));
  for (Eigen::Index j = 0; j < x.cols(); ++j) {
    const double* column = x_.col(block.dofs[static_cast<std::size_t>(j)]).data();
    for (Eigen::Index i = 0; i < x.rows(); ++i) x(i, j) = column[rows[static_cast<std::size_t>(i)]];
  }
  const fem::RowMajor xw = fem::row_product(fem::plain(x), fem::RowMajor(added.w));
  blocks_.push_back(std::move(added));
  columns_ += block.w.cols();
  Eigen::MatrixXd gram(columns_, block.w.cols());
  Eigen::Index row = 0;
  for (const Block& b : blocks_) {
    gram.middleRows(row, b.w.cols()) =
        fem::row_product(fem::transposed(b.w), fem::RowMajor(xw(b.places, Eigen::all)));
    row += b.w.cols();
  }
  return gram;
}

void InverseBase::pop() {
  columns_ -= blocks_.back().w.cols();
  blocks_.pop_back();
  touched_.pop();
}

const Eigen::VectorXd& InverseBase::load(const Forces& forces) {
  load_dofs_.assign(forces.dofs.begin(), forces.dofs.end());
  load_values_.assign(forces.values.begin(), forces.values.end());
  // Two solves read the factor twice, index and value; a column of X costs n.
  dense_load_ = forces.dofs.size() * static_cast<std::size_t>(size()) > 4 * factor_.entries();
  const auto rows = touched_.list();
  at_touched_.setZero(touched_.size());
  if (dense_load_) {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(size());
    for (std::size_t i = 0; i < load_dofs_.size(); ++i) f[load_dofs_[i]] = load_values_[i];
    of_load_ = factor_.solve(f);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      at_touched_[static_cast<Eigen::Index>(i)] = of_load_[rows[i]];
    }
  } else {
    for (std::size_t l = 0; l < load_dofs_.size(); ++l) {
      const double* column = x_.col(load_dofs_[l]).data();
      for (std::size_t i = 0; i < rows.size(); ++i) {
        at_touched_[static_cast<Eigen::Index>(i)] += load_values_[l] * column[rows[i]];
      }
    }
  }
  projected_.resize(columns_);
  Eigen::Index row = 0;
  for (const Block& b : blocks_) {
    for (Eigen::Index c = 0; c < b.w.cols(); ++c) {
      double sum = 0;
      for (std::size_t i = 0; i < b.places.size(); ++i) {
        sum += b.w(static_cast<Eigen::Index>(i), c) * at_touched_[b.places[i]];
      }
      projected_[row++] = sum;
    }
  }
  return projected_;
}

void InverseBase::expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) {
  at_touched_.setZero(touched_.size());  // V c
  Eigen::Index row = 0;
  for (const Block& b : blocks_) {
    for (Eigen::Index k = 0; k < b.w.cols(); ++k, ++row) {
      for (std::size_t i = 0; i < b.places.size(); ++i) {
        at_touched_[b.places[i]] += b.w(static_cast<Eigen::Index>(i), k) * c[row];
      }
    }
  }
  if (dense_load_) {
    u = of_load_;
  } else {
    u.setZero(size());
    add_columns(x_, load_dofs_, load_values_, u);
  }
  add_columns(x_, touched_.list(),
              {at_touched_.data(), static_cast<std::size_t>(at_touched_.size())}, u);
}

std::vector<BufferPlan> InverseBase::buffers() const {
  return {{"inverse (dense, n x n)", static_cast<std::size_t>(x_.size()) * sizeof(double)}};
}

}  // namespace sunder::engine
