// SPDX-License-Identifier: Apache-2.0
#include "gpu/host_base.hpp"

#include <algorithm>

namespace sunder::gpu {

HostBase::HostBase(std::shared_ptr<const HostInverse> inverse) : inverse_(std::move(inverse)) {
  columns_.resize(inverse_->factor().cholesky().size(), 0);
}

void HostBase::push(std::span<const solver::Difference> vectors, linear_algebra::RowMajor& gram) {
  pushes_.push_back(vectors_.size());
  const Index before = count(), added = static_cast<Index>(vectors.size());
  vectors_.insert(vectors_.end(), vectors.begin(), vectors.end());
  if (count() > columns_.cols()) {
    columns_.conservativeResize(Eigen::NoChange, std::max(count(), 2 * before));
  }
  inverse_->differences(vectors, columns_.middleCols(before, added));
  for (Index j = 0; j < added; ++j) {
    const double* column = columns_.col(before + j).data();
    for (Index i = 0; i < count(); ++i) {
      const auto [dof, other] = vectors_[static_cast<std::size_t>(i)];
      gram(i, j) = other == kNone ? column[dof] : column[dof] - column[other];
    }
  }
}

void HostBase::pop() {
  vectors_.resize(pushes_.back());
  pushes_.pop_back();
  projected_columns_ = std::min(projected_columns_, count());
}

const Eigen::VectorXd& HostBase::load(const solver::Forces& forces) {
  if (load_.take(forces)) projected_columns_ = 0;
  if (projected_.size() < count()) projected_.conservativeResize(2 * count() + 256);
  for (; projected_columns_ < count(); ++projected_columns_) {
    const double* column = columns_.col(projected_columns_).data();
    double sum = 0;
    for (std::size_t i = 0; i < forces.dofs.size(); ++i) {
      sum += forces.values[i] * column[forces.dofs[i]];
    }
    projected_[projected_columns_] = sum;
  }
  return projected_;
}

void HostBase::expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) {
  right_side_.setZero(size());
  for (std::size_t i = 0; i < load_.dofs().size(); ++i) {
    right_side_[load_.dofs()[i]] += load_.values()[i];
  }
  for (Index i = 0; i < count(); ++i) {
    const auto [dof, other] = vectors_[static_cast<std::size_t>(i)];
    right_side_[dof] += c[i];
    if (other != kNone) right_side_[other] -= c[i];
  }
  inverse_->factor().solve(right_side_, u, work_);
}

std::vector<BufferPlan> HostBase::buffers() const {
  return {{"factor and inverse of the base (host)", inverse_->bytes()},
          {"exact columns (host)", static_cast<std::size_t>(columns_.size()) * sizeof(double)}};
}

}  // namespace sunder::gpu
