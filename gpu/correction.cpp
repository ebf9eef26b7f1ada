// SPDX-License-Identifier: Apache-2.0
#include "gpu/correction.hpp"

#include <Eigen/QR>
#include <algorithm>

#include "fem/event_factor.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {

Eigen::MatrixXd compressed(const Eigen::MatrixXd& w) {
  if (w.cols() <= w.rows()) return w;
  // W^T = Q R, so W W^T = R^T R; without the squared condition of a Cholesky of W W^T.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(w.transpose());
  const Eigen::MatrixXd r = qr.matrixQR().topRows(w.rows()).triangularView<Eigen::Upper>();
  return r.transpose();
}

Correction::Correction(const Problem& problem, Columns columns)
    : problem_(problem), base_(std::move(columns)) {
  place_.assign(static_cast<std::size_t>(problem.dof_count()), kNone);
  columns_.resize(problem.dof_count(), 0);
  extend(problem.gripped_dofs());
  factor_grips();
}

Index Correction::new_dofs(std::span<const Index> dofs) const {
  return static_cast<Index>(
      std::count_if(dofs.begin(), dofs.end(), [&](Index d) { return place_[d] == kNone; }));
}

Index Correction::new_dofs_of(std::span<const Index> elements) const {
  return new_dofs(fem::event_factor(problem_, elements).dofs);
}

void Correction::extend(std::span<const Index> dofs) {
  std::vector<Index> added;
  for (Index d : dofs) {
    if (place_[d] != kNone) continue;
    place_[d] = count();
    dofs_.push_back(d);
    added.push_back(d);
  }
  if (added.empty()) return;
  const Index before = count() - static_cast<Index>(added.size());
  if (count() > columns_.cols()) {
    columns_.conservativeResize(Eigen::NoChange, std::max(count(), 2 * before));
  }
  columns_.middleCols(before, count() - before) = base_(added);
  m_.conservativeResizeLike(Eigen::MatrixXd::Zero(count(), count()));
  x_.conservativeResize(count(), count());
  for (Index j = before; j < count(); ++j) {
    for (Index i = 0; i < count(); ++i) x_(i, j) = x_(j, i) = columns_(dofs_[i], j);
  }
}

bool Correction::destroy(std::span<const Index> elements) {
  const fem::EventFactor event = fem::event_factor(problem_, elements);
  if (event.dofs.empty()) return true;  // every corner is held: nothing changes
  extend(event.dofs);
  const Eigen::MatrixXd w = compressed(event.w);
  std::vector<Index> at;
  for (Index d : event.dofs) at.push_back(place_[d]);
  Eigen::MatrixXd v = m_ * (x_(Eigen::all, at) * w);  // X' W = X_E V
  v(at, Eigen::all) += w;
  Eigen::MatrixXd c = -w.transpose() * (x_(at, Eigen::all) * v);
  c.diagonal().array() += 1;
  const Eigen::LLT<Eigen::MatrixXd> llt(c);
  if (llt.info() != Eigen::Success || !llt.matrixLLT().allFinite()) return false;
  const Eigen::MatrixXd z = llt.matrixL().solve(v.transpose()).transpose();
  if (!z.allFinite()) return false;
  m_.noalias() += z * z.transpose();
  factor_grips();
  return true;
}

void Correction::factor_grips() {
  const Index g = static_cast<Index>(problem_.gripped_dofs().size());
  if (g == 0) return;
  grips_.compute(x_.topLeftCorner(g, g) + x_.topRows(g) * m_ * x_.leftCols(g));
  if (grips_.info() != Eigen::Success) {
    throw NumericalError("the compliance of the gripped nodes is singular in double precision");
  }
}

Eigen::VectorXd Correction::take_exact(Loaded& load) const {
  Eigen::VectorXd taken = Eigen::VectorXd::Zero(count());
  Loaded rest;
  for (std::size_t i = 0; i < load.dofs.size(); ++i) {
    const Index at = place_[load.dofs[i]];
    if (at != kNone) {
      taken[at] = load.values[i];
    } else {
      rest.dofs.push_back(load.dofs[i]);
      rest.values.push_back(load.values[i]);
    }
  }
  load = std::move(rest);
  return taken;
}

Eigen::VectorXd Correction::project(const Loaded& load) const {
  Eigen::VectorXd a = Eigen::VectorXd::Zero(count());
  Loaded rest;
  for (std::size_t i = 0; i < load.dofs.size(); ++i) {
    const Index at = place_[load.dofs[i]];
    if (at != kNone) {
      a += load.values[i] * x_.col(at);
    } else {
      rest.dofs.push_back(load.dofs[i]);
      rest.values.push_back(load.values[i]);
    }
  }
  for (Index j = 0; j < count(); ++j) {
    double sum = 0;
    for (std::size_t i = 0; i < rest.dofs.size(); ++i) {
      sum += rest.values[i] * columns_(rest.dofs[i], j);
    }
    a[j] += sum;
  }
  return a;
}

double Correction::energy(const Eigen::VectorXd& projection) const {
  if (count() == 0) return 0;
  return projection.dot(m_ * projection);
}

double Correction::base_energy(const Eigen::VectorXd& values) const {
  if (count() == 0) return 0;
  return values.dot(x_ * values);
}

Eigen::VectorXd Correction::coefficients(const Eigen::VectorXd& projection,
                                         std::span<const double> displacement) const {
  if (count() == 0) return {};
  const Index g = static_cast<Index>(problem_.gripped_dofs().size());
  Eigen::VectorXd c = m_ * projection;
  if (g == 0) return c;
  // The grips' forces close the gap between u_G and what is prescribed there.
  Eigen::VectorXd gap = -(projection.head(g) + x_.topRows(g) * c);
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    gap[static_cast<Index>(i)] += displacement[i];
  }
  const Eigen::VectorXd forces = grips_.solve(gap);
  c += m_ * (x_.leftCols(g) * forces);
  c.head(g) += forces;
  return c;
}

std::size_t Correction::bytes() const {
  return static_cast<std::size_t>(columns_.size() + x_.size() + m_.size()) * sizeof(double);
}

}  // namespace sunder::gpu
