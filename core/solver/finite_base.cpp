// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_base.hpp"

namespace sunder::solver {
namespace {

/// Known unknowns get equations of their own.
void uncouple(linear_algebra::SparseMatrix& lower, std::span<const Index> unknowns) {
  std::vector<std::uint8_t> known(static_cast<std::size_t>(lower.cols()), 0);
  for (Index d : unknowns) known[d] = 1;
  for (Index column = 0; column < lower.cols(); ++column) {
    for (linear_algebra::SparseMatrix::InnerIterator it(lower, column); it; ++it) {
      if (known[it.row()] || known[column]) it.valueRef() = it.row() == column ? 1 : 0;
    }
  }
}

linear_algebra::SparseMatrix tangent(const fem::HyperelasticBody& body, std::span<const double> u,
                                     fem::Tangent kind) {
  linear_algebra::SparseMatrix lower = fem::assemble_tangent(body, u, kind);
  uncouple(lower, body.problem.gripped_dofs());
  return lower;
}

}  // namespace

FiniteBase::FiniteBase(const RestingBody& body, std::vector<double> u, fem::Tangent kind,
                       const std::vector<Index>& order)
    : u_(std::move(u)), factor_(tangent(body.body(), u_, kind), order) {}

void FiniteBase::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) { factor_.solve(b, x, work_); }

}  // namespace sunder::solver
