// SPDX-License-Identifier: Apache-2.0
#include "solver/inverse_base.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "solver/columns.hpp"

namespace sunder::solver {

// Not made symmetric: each column as solved is good to 1e-12 of stress, the mean of column and row
// to 3e-11.
Eigen::MatrixXd InverseBase::inverse_of(const linear_algebra::Factor& factor) {
  std::vector<Index> all(static_cast<std::size_t>(factor.cholesky().size()));
  std::iota(all.begin(), all.end(), 0);
  return factor.inverse_columns(all, linear_algebra::work_at_once());
}

InverseBase::InverseBase(const linear_algebra::Factor& factor,
                         std::shared_ptr<const Eigen::MatrixXd> inverse)
    : factor_(factor), x_(std::move(inverse)) {
  of_load_.setZero(x_->rows());
  right_side_.setZero(x_->rows());
  projected_.resize(1024);
  place_.assign(static_cast<std::size_t>(x_->rows()), kNone);
  touched_.reserve(place_.size());
  forces_.reserve(place_.size());
  vectors_.reserve(1024);
  pushes_.reserve(1024);
}

// Two solves read the factor twice; a column of X costs n.
bool InverseBase::too_many(std::size_t columns) const {
  return columns * static_cast<std::size_t>(size()) > 2 * factor_.entries();
}

void InverseBase::push(std::span<const Difference> vectors, linear_algebra::RowMajor& gram) {
  pushes_.push_back(vectors_.size());
  vectors_.insert(vectors_.end(), vectors.begin(), vectors.end());
  for (const Difference& v : vectors) {
    for (Index d : {v.dof, v.other}) {
      if (d == kNone || place_[d] != kNone) continue;
      place_[d] = static_cast<Index>(touched_.size());
      touched_.push_back(d);
    }
  }
  for (std::size_t j = 0; j < vectors.size(); ++j) {
    const double* a = x_->col(vectors[j].dof).data();
    const double* b = vectors[j].other == kNone ? nullptr : x_->col(vectors[j].other).data();
    for (std::size_t i = 0; i < vectors_.size(); ++i) {
      const auto [dof, other] = vectors_[i];
      double value = b ? a[dof] - b[dof] : a[dof];
      if (other != kNone) value -= b ? a[other] - b[other] : a[other];
      gram(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = value;
    }
  }
}

void InverseBase::pop() {
  vectors_.resize(pushes_.back());
  pushes_.pop_back();
  for (Index d : touched_) place_[d] = kNone;
  touched_.clear();
  for (const Difference& v : vectors_) {
    for (Index d : {v.dof, v.other}) {
      if (d == kNone || place_[d] != kNone) continue;
      place_[d] = static_cast<Index>(touched_.size());
      touched_.push_back(d);
    }
  }
}

void InverseBase::apply(std::span<const Index> dofs, std::span<const double> values,
                        Eigen::VectorXd& u) {
  if (too_many(dofs.size())) {
    right_side_.setZero();
    for (std::size_t i = 0; i < dofs.size(); ++i) right_side_[dofs[i]] += values[i];
    factor_.solve(right_side_, u, work_);
  } else {
    u.setZero(size());
    add_columns(*x_, dofs, values, u);
  }
}

void InverseBase::project(const Eigen::VectorXd& u, Eigen::VectorXd& projected) const {
  const auto count = static_cast<Eigen::Index>(vectors_.size());
  if (projected.size() < count) projected.resize(2 * count + 256);
  for (std::size_t i = 0; i < vectors_.size(); ++i) {
    const auto [dof, other] = vectors_[i];
    projected[static_cast<Eigen::Index>(i)] = other == kNone ? u[dof] : u[dof] - u[other];
  }
}

const Eigen::VectorXd& InverseBase::load(const Forces& forces) {
  if (load_.take(forces)) apply(load_.dofs(), load_.values(), of_load_);
  project(of_load_, projected_);
  return projected_;
}

void InverseBase::expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) {
  forces_.assign(touched_.size(), 0.0);
  for (std::size_t i = 0; i < vectors_.size(); ++i) {
    const double force = c[static_cast<Eigen::Index>(i)];
    forces_[place_[vectors_[i].dof]] += force;
    if (vectors_[i].other != kNone) forces_[place_[vectors_[i].other]] -= force;
  }
  apply(touched_, forces_, u);
  u += of_load_;
}

std::vector<BufferPlan> InverseBase::buffers() const {
  return {{"inverse (dense, n x n)", static_cast<std::size_t>(x_->size()) * sizeof(double)}};
}

}  // namespace sunder::solver
