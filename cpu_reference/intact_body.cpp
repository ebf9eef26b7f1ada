// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/intact_body.hpp"

#include <algorithm>
#include <utility>

#include "sunder/error.hpp"

namespace sunder::cpu_reference {

std::shared_ptr<const linear_algebra::Factor> factor_of(const fem::Analysis& analysis) {
  return std::make_shared<const linear_algebra::Factor>(analysis.nodes, analysis.ordered,
                                                        linear_algebra::work_at_once());
}

void Grips::set_columns(Eigen::MatrixXd columns) {
  columns_ = std::move(columns);
  factor();
}

void Grips::read(const Eigen::MatrixXd& inverse) {
  if (none()) return;
  columns_.resize(inverse.rows(), static_cast<Index>(dofs_.size()));
  for (std::size_t i = 0; i < dofs_.size(); ++i) {
    columns_.col(static_cast<Index>(i)) = inverse.col(dofs_[i]);
  }
  factor();
}

void Grips::factor() {
  at_grips_.resize(columns_.cols(), columns_.cols());
  for (Index i = 0; i < columns_.cols(); ++i) {
    at_grips_.row(i) = columns_.row(dofs_[static_cast<std::size_t>(i)]);
  }
  block_.compute(at_grips_);
  if (block_.info() != Eigen::Success) {
    throw NumericalError("the compliance of the gripped nodes is singular in double precision");
  }
}

void Grips::hold(Eigen::VectorXd& x, std::span<const double> displacement) const {
  if (none()) return;
  gap_.resize(static_cast<Index>(dofs_.size()));
  for (std::size_t i = 0; i < dofs_.size(); ++i) {
    gap_[static_cast<Index>(i)] = (displacement.empty() ? 0.0 : displacement[i]) - x[dofs_[i]];
  }
  block_.solveInPlace(gap_);
  x.noalias() += columns_ * gap_;
  for (std::size_t i = 0; i < dofs_.size(); ++i) {
    x[dofs_[i]] = displacement.empty() ? 0.0 : displacement[i];  // free of rounding
  }
}

IntactBody::IntactBody(const Problem& problem, bool rebases, const fem::Analysis& analysis)
    : IntactBody(problem, rebases, analysis, factor_of(analysis)) {}

IntactBody::IntactBody(const Problem& problem, bool rebases, const fem::Analysis& analysis,
                       std::shared_ptr<const linear_algebra::Factor> of)
    : factor_(std::move(of)), factor(*factor_), grips(problem.gripped_dofs()) {
  if (rebases) {
    factors = std::make_unique<fem::BodyFactors>(problem, analysis.nodes, analysis.ordered);
  }
  if (!grips.none()) grips.set_columns(factor.inverse_columns(grips.dofs()));
}

void IntactBody::solve(const Eigen::VectorXd& f, std::span<const double> displacement,
                       Eigen::VectorXd& x) const {
  solve(f, grips, displacement, x);
}

void IntactBody::solve(const Eigen::VectorXd& f, const Grips& by,
                       std::span<const double> displacement, Eigen::VectorXd& x) const {
  factor.solve(f, x, work_);
  by.hold(x, displacement);
}

const Grips& PresentGrips::now() const {
  const auto gripped = body_.forms().gripped();
  if (std::ranges::equal(gripped, intact_.grips.dofs())) return intact_.grips;
  if (!others_ || !std::ranges::equal(gripped, others_->dofs())) {
    others_.emplace(gripped);
    others_->set_columns(intact_.factor.inverse_columns(gripped));
  }
  return *others_;
}

}  // namespace sunder::cpu_reference
