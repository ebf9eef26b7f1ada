// SPDX-License-Identifier: Apache-2.0
#include "engine/deferred.hpp"

#include <algorithm>

#include "engine/update_vectors.hpp"
#include "sunder/error.hpp"

namespace sunder::engine {

Deferred::Deferred(std::unique_ptr<Base> base, std::span<const Index> gripped)
    : base_(std::move(base)), gripped_(gripped.begin(), gripped.end()) {
  const auto g = static_cast<Eigen::Index>(gripped_.size());
  grip_rows_.resize(0, g);
  if (g == 0) return;
  grip_x_ = base_->push({gripped_, Eigen::MatrixXd::Identity(g, g)});
  if (!factor_grips()) {
    throw NumericalError("the compliance of the gripped nodes is singular in double precision");
  }
}

bool Deferred::factor_grips() {
  if (gripped_.empty()) return true;
  grip_block_.compute(grip_x_ + grip_rows_.transpose() * grip_rows_);
  return grip_block_.info() == Eigen::Success && grip_block_.matrixLLT().allFinite();
}

bool Deferred::destroy(const Problem& problem, std::span<const Index> elements) {
  const fem::EventFactor event = compressed(fem::event_factor(problem, elements));
  const auto g = static_cast<Eigen::Index>(gripped_.size());
  const Eigen::Index k = event.w.cols(), before = small_.size();
  const Eigen::MatrixXd gram = base_->push(event);
  Eigen::MatrixXd block = -gram.bottomRows(k);
  block.diagonal().array() += 1;
  ranks_.push_back(static_cast<Index>(before));
  elements_.emplace_back(elements.begin(), elements.end());
  if (!small_.append(-gram.middleRows(g, before), block)) {
    base_->pop();
    ranks_.pop_back();
    elements_.pop_back();
    return false;
  }
  if (g > 0) {
    // The rows of earlier events stay: forward substitution reaches them first.
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(before + k, g);
    rows.topRows(before) = grip_rows_;
    rows.bottomRows(k) = gram.topRows(g).transpose();
    small_.solve_lower_from(before, rows);
    grip_rows_ = std::move(rows);
  }
  if (factor_grips()) return true;
  take_back();
  return false;
}

void Deferred::take_back() {
  if (ranks_.empty()) throw UsageError("there is no event to take back");
  base_->pop();
  small_.shrink(ranks_.back());
  ranks_.pop_back();
  elements_.pop_back();
  grip_rows_.conservativeResize(small_.size(), Eigen::NoChange);
  if (!factor_grips()) throw NumericalError("the compliance of the gripped nodes is singular");
}

bool Deferred::compact(const Problem& problem) {
  std::vector<Index> all;
  for (const auto& event : elements_) all.insert(all.end(), event.begin(), event.end());
  while (!elements_.empty()) take_back();
  std::sort(all.begin(), all.end());
  return all.empty() || destroy(problem, all);
}

void Deferred::solve(const Forces& forces, std::span<const double> displacement,
                     Eigen::VectorXd& u) {
  const Eigen::VectorXd& projected = base_->load(forces);
  const auto g = static_cast<Eigen::Index>(gripped_.size());
  const Eigen::Index rank = small_.size();
  coefficients_.resize(g + rank);
  auto c = coefficients_.tail(rank);
  c = projected.tail(rank);
  small_.solve_lower(c);  // L^-1 W^T X f
  if (g > 0) {
    forces_ = -projected.head(g);
    forces_.noalias() -= grip_rows_.transpose() * c;
    for (std::size_t i = 0; i < displacement.size(); ++i) {
      forces_[static_cast<Eigen::Index>(i)] += displacement[i];
    }
    grip_block_.solveInPlace(forces_);
    c.noalias() += grip_rows_ * forces_;
    coefficients_.head(g) = forces_;
  }
  small_.solve_upper(c);
  base_->expand(coefficients_, u);
  for (std::size_t i = 0; i < gripped_.size(); ++i) {
    u[gripped_[i]] = displacement.empty() ? 0.0 : displacement[i];  // free of rounding
  }
}

std::vector<BufferPlan> Deferred::buffers() const {
  std::vector<BufferPlan> plan = base_->buffers();
  plan.push_back({"small matrix of the damage", small_.bytes()});
  return plan;
}

}  // namespace sunder::engine
