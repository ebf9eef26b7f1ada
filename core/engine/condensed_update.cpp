// SPDX-License-Identifier: Apache-2.0
#include "engine/condensed_update.hpp"

namespace sunder::engine {
namespace {

/// B^T X (`rows`) or (X B)^T.
fem::RowMajor differences_of(const CondensedState& state, std::span<const Index> place, bool rows) {
  const Eigen::MatrixXd& x = *state.x;
  fem::RowMajor result(static_cast<Eigen::Index>(state.vectors.size()), x.rows());
  for (std::size_t i = 0; i < state.vectors.size(); ++i) {
    const auto [dof, other] = state.vectors[i];
    auto row = result.row(static_cast<Eigen::Index>(i));
    if (rows) {
      row = x.row(place[dof]);
      if (other != kNone) row -= x.row(place[other]);
    } else {
      row = x.col(place[dof]).transpose();
      if (other != kNone) row -= x.col(place[other]).transpose();
    }
  }
  return result;
}

fem::RowMajor product(const fem::RowMajor& symmetric, const fem::RowMajor& b) {
  return fem::row_product(fem::transposed(symmetric), b);
}

/// The forces of the damage under each column's unit load: one step of Deferred::refine().
fem::RowMajor forces_of(const Damage& damage, const fem::RowMajor& p) {
  fem::RowMajor x = product(damage.m, p);
  const fem::RowMajor lack = product(damage.d, product(damage.compliance, x) + p) - x;
  x += lack + product(damage.m, product(damage.compliance, lack));
  return x;
}

}  // namespace

Eigen::MatrixXd updated_inverse(const CondensedState& state, const Damage& damage) {
  std::vector<Index> place(static_cast<std::size_t>(state.factor->cholesky().size()), kNone);
  for (std::size_t i = 0; i < state.dofs.size(); ++i) place[state.dofs[i]] = static_cast<Index>(i);
  const fem::RowMajor x = forces_of(damage, differences_of(state, place, true));
  const fem::RowMajor columns = differences_of(state, place, false);
  Eigen::MatrixXd result = *state.x;
  // Column by column, which row_product() takes for rows: X'^T = X^T + x^T (X B)^T.
  fem::row_product_add(fem::transposed(x), columns.data(), columns.outerStride(), columns.cols(),
                       result.data(), result.outerStride());
  return result;
}

}  // namespace sunder::engine
