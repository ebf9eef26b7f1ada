// SPDX-License-Identifier: Apache-2.0
#include "gpu/host_base.hpp"

#include <algorithm>

#include "gpu/passes/inverse_refinement.hpp"

namespace sunder::gpu {
namespace {

// Room for columns from the start, if it takes no more memory than that; for as many unit vectors
// as two elements touch.
constexpr Index kUnits = 24;
constexpr std::size_t kRoomBytes = std::size_t{64} << 20;

// So many columns tell whether others are to be refined: where one is off by more than a fifth of
// what an intact body's displacement may be, of a torn one half of that.
constexpr Index kTried = 12;
constexpr double kExact = 2e-10, kExactTorn = 5e-10;
// What is off by more is another inverse.
constexpr double kSame = 1e-6;

}  // namespace

HostBase::HostBase(std::shared_ptr<const HostInverse> inverse, const fem::DamagedBody* body,
                   const DenseInverse* device, Index columns)
    : inverse_(std::move(inverse)), device_(device), room_(columns) {
  columns_.resize(inverse_->factor().cholesky().size(), 0);
  if (!body || inverse_->is_dense()) return;
  body_ = *body;
  try_columns();
}

/// Some that lie evenly, ascending.
std::vector<Index> HostBase::tried_unknowns() const {
  std::vector<Index> dofs;
  for (Index i = 0; i < kTried; ++i) dofs.push_back(i * size() / kTried);
  dofs.erase(std::unique(dofs.begin(), dofs.end()), dofs.end());
  return dofs;
}

/// Refines some columns, to see what that changes.
void HostBase::try_columns() {
  dofs_ = tried_unknowns();
  Eigen::MatrixXd some(size(), static_cast<Index>(dofs_.size()));
  read_units(dofs_, some);
  const bool torn = std::ranges::count(body_->destroyed(), 1) > 0;
  refines_ = refine(dofs_, some) > (torn ? kExactTorn : kExact);
}

void HostBase::keep_columns() { kept_ = unit_columns(tried_unknowns()); }

bool HostBase::try_device(const DenseInverse& device) {
  Eigen::MatrixXd there(kept_.rows(), kept_.cols());
  device.read_columns(tried_unknowns(), there);
  double off = 0;
  for (Eigen::Index c = 0; c < kept_.cols(); ++c) {
    const double of_column = (there.col(c) - kept_.col(c)).norm() / kept_.col(c).norm();
    if (!(of_column <= kSame)) return false;
    off = std::max(off, of_column);
  }
  // What was kept is the factor's: refined, or by itself up to as much off.
  refines_ = body_ && off > (refines_ ? 1 : 2) * kExactTorn;
  kept_.resize(0, 0);
  read_from(&device);
  return true;
}

Eigen::MatrixXd HostBase::unit_columns(std::span<const Index> dofs) {
  Eigen::MatrixXd columns(size(), static_cast<Index>(dofs.size()));
  read_units(dofs, columns);
  return columns;
}

void HostBase::read_units(std::span<const Index> dofs, Eigen::Ref<Eigen::MatrixXd> to) {
  if (device_) {
    device_->read_columns(dofs, to);
  } else {
    to = inverse_->columns(dofs);
  }
  if (refines_) refine(dofs, to);
}

/// Returns the largest change of one, relative to its norm.
double HostBase::refine(std::span<const Index> dofs, Eigen::Ref<Eigen::MatrixXd> columns) {
  unit_residuals(*body_, dofs, columns, lacks_);
  inverse_->factor().solve(lacks_, block_, work_);
  double most = 0;
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    most = std::max(most, lacks_.col(i).norm() / columns.col(i).norm());
  }
  columns += lacks_;
  return most;
}

void HostBase::make_room() {
  const auto fits = static_cast<Index>(kRoomBytes / (static_cast<std::size_t>(size()) * 8 + 1));
  if (columns_.cols() < std::min(room_, fits)) {
    columns_.conservativeResize(Eigen::NoChange, std::min(room_, fits));
  }
  if (!inverse_->is_dense()) units_.resize(size(), kUnits);
}

/// X B_new to columns_, from the first on.
void HostBase::add_columns(std::span<const solver::Difference> vectors, Eigen::Index first) {
  dofs_.clear();
  for (const solver::Difference& v : vectors) {
    dofs_.push_back(v.dof);
    if (v.other != kNone) dofs_.push_back(v.other);
  }
  std::sort(dofs_.begin(), dofs_.end());
  dofs_.erase(std::unique(dofs_.begin(), dofs_.end()), dofs_.end());
  const bool dense = inverse_->is_dense();
  if (!dense) {
    const auto count = static_cast<Eigen::Index>(dofs_.size());
    if (units_.cols() < count) units_.resize(size(), count);
    read_units(dofs_, units_.leftCols(count));
  }
  const auto column = [&](Index dof) {
    if (dense) return inverse_->dense().col(dof);
    const auto at = std::lower_bound(dofs_.begin(), dofs_.end(), dof) - dofs_.begin();
    return std::as_const(units_).col(at);
  };
  for (const auto& [dof, other] : vectors) {
    columns_.col(first) = column(dof);
    if (other != kNone) columns_.col(first) -= column(other);
    ++first;
  }
}

void HostBase::push(std::span<const solver::Difference> vectors, linear_algebra::RowMajor& gram) {
  pushes_.push_back(vectors_.size());
  const Index before = count(), added = static_cast<Index>(vectors.size());
  vectors_.insert(vectors_.end(), vectors.begin(), vectors.end());
  if (count() > columns_.cols()) {
    columns_.conservativeResize(Eigen::NoChange, std::max(count(), 2 * before));
  }
  add_columns(vectors, before);
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
  std::vector<BufferPlan> plan = {
      {"factor and inverse of the base (host)", inverse_->bytes()},
      {"exact columns (host)",
       static_cast<std::size_t>(columns_.size() + units_.size()) * sizeof(double)}};
  if (factors_ && factors_->bytes() > 0) {
    plan.push_back({"stiffness in the factor's order (host)", factors_->bytes()});
  }
  return plan;
}

}  // namespace sunder::gpu
