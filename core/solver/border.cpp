// SPDX-License-Identifier: Apache-2.0
#include "solver/border.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "body/element.hpp"
#include "material/linear.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
void Border::assemble(const fem::Forms& forms, DifferenceBasis& basis, Eigen::Index grips,
                      Eigen::Index columns) {
  unknowns_.follow(forms);
  for (Eigen::VectorXd* v : {&load_, &d_, &lack_, &step_}) v->setZero(unknowns_.count());
  if (empty()) return;
  entries_.clear();
  f_.setZero(size(), size());
  const Index first = forms.problem().node_count();
  for (const auto& [element, form] : forms.came()) {
    const bool at_new = std::ranges::any_of(form.corners, [&](Index n) { return n >= first; });
    if (at_new && form.share > 0) add(forms, form, basis, grips);
  }
  e_.resize(columns, size());
  e_.setFromTriplets(entries_.begin(), entries_.end());
  for (std::size_t i = 0; i < unknowns_.nodes().size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index own = unknowns_.unknown(static_cast<Index>(i), axis);
      if (own != kNone) f_(own, own) += unknowns_.nodes()[i].tie;
    }
  }
}

/// An element's K = W W^T, W = share^1/2 B^T L V^1/2, joins E and F.
void Border::add(const fem::Forms& forms, const fem::Form& form, DifferenceBasis& basis,
                 Eigen::Index grips) {
  const fem::UpdateFactor w =
      fem::update_factor(form.shape, elasticity(form.law), 0) * std::sqrt(form.share);
  basis.coordinates(forms.parents(form.corners), w, rows_, y_);
  std::array<Index, 12> own;
  for (int i = 0; i < 12; ++i) {
    const Index added =
        form.corners[static_cast<std::size_t>(i / 3)] - forms.problem().node_count();
    own[static_cast<std::size_t>(i)] = added < 0 ? kNone : unknowns_.unknown(added, i % 3);
  }
  for (int j = 0; j < 12; ++j) {
    const Index column = own[static_cast<std::size_t>(j)];
    if (column == kNone) continue;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      entries_.emplace_back(static_cast<int>(grips) + rows_[r], column,
                            y_.row(static_cast<Eigen::Index>(r)).head<6>().dot(w.row(j)));
    }
    for (int i = 0; i < 12; ++i) {
      const Index row = own[static_cast<std::size_t>(i)];
      if (row != kNone) f_(row, column) += w.row(i).dot(w.row(j));
    }
  }
}

/// x += sign N d.
void Border::add_product_e(const Eigen::VectorXd& d, double sign, Eigen::VectorXd& x) const {
  for (Eigen::Index j = 0; j < e_.outerSize(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator at(e_, j); at; ++at) {
      x[at.row()] += sign * at.value() * d[j];
    }
  }
  x.head(n_.rows()).noalias() += sign * (n_ * d);
}

bool Border::factor(const linear_algebra::RowMajor& g, const linear_algebra::RowMajor& m,
                    Eigen::Index changed) {
  if (empty()) return true;
  const Eigen::Index n = e_.rows(), k = std::min(changed, n);
  h_.setZero(n, size());  // G E; G is symmetric, its rows lie together
  for (Eigen::Index j = 0; j < e_.outerSize(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator at(e_, j); at; ++at) {
      h_.col(j) += at.value() * g.row(at.row()).head(n).transpose();
    }
  }
  n_.noalias() = m.topLeftCorner(k, k) * h_.topRows(k);
  h_.noalias() += g.topLeftCorner(n, k) * n_;  // G N
  Eigen::MatrixXd s = f_;
  s.noalias() -= e_.transpose() * h_;
  for (Eigen::Index j = 0; j < s.cols(); ++j) {
    if (f_(j, j) == 0) s(j, j) = 1;  // no element there (any more): its offset is 0
  }
  s_.compute(s.selfadjointView<Eigen::Lower>());
  return s_.info() == Eigen::Success && s_.matrixLLT().allFinite();
}

void Border::add_to_grips(Eigen::MatrixXd& compliance) const {
  const Eigen::Index g = compliance.rows();
  const Eigen::MatrixXd t = s_.matrixL().solve(h_.topRows(g).transpose());
  compliance.noalias() += t.transpose() * t;
}

Forces Border::take(const Forces& forces, Index first) {
  dofs_.clear();
  values_.clear();
  load_.setZero();
  for (std::size_t i = 0; i < forces.dofs.size(); ++i) {
    const Index own = forces.dofs[i] - first;
    if (own < 0) {
      dofs_.push_back(forces.dofs[i]);
      values_.push_back(forces.values[i]);
    } else if (own >= size()) {
      throw UsageError("there is no unknown " + std::to_string(forces.dofs[i]) +
                       " for a force to act on");
    } else if (f_(own, own) > 0) {
      load_[own] = forces.values[i];
    }
  }
  return {dofs_, values_};
}

void Border::start(const Eigen::VectorXd& p, Eigen::VectorXd& x) {
  d_ = load_;
  d_.noalias() -= e_.transpose() * p.head(e_.rows());
  d_.noalias() -= n_.transpose() * p.head(n_.rows());
  s_.solveInPlace(d_);
  add_product_e(d_, -1, x);
}

void Border::add_lack(const Eigen::VectorXd& v, Eigen::VectorXd& lack) {
  const Eigen::Index n = e_.rows();
  lack.head(n).noalias() -= e_ * d_;
  lack_ = load_;
  lack_.noalias() -= e_.transpose() * v.head(n);
  lack_.noalias() -= f_ * d_;
}

double Border::correct(const Eigen::VectorXd& lack, Eigen::VectorXd& x, Eigen::VectorXd& moved) {
  const Eigen::Index n = e_.rows();
  lack_.noalias() -= h_.transpose() * lack.head(n);
  step_ = lack_;
  s_.solveInPlace(step_);
  d_ += step_;
  add_product_e(step_, -1, x);
  moved.noalias() -= h_.topRows(moved.size()) * step_;
  return lack_.dot(step_);
}

void Border::follow_grips(const Eigen::VectorXd& forces, Eigen::VectorXd& x) {
  step_.noalias() = h_.topRows(forces.size()).transpose() * forces;
  s_.solveInPlace(step_);
  d_ -= step_;
  add_product_e(step_, 1, x);
}

std::size_t Border::bytes() const {
  const Eigen::Index doubles = 2 * e_.nonZeros() + f_.size() + n_.size() + h_.size() + f_.size();
  return empty() ? 0 : static_cast<std::size_t>(doubles) * sizeof(double);
}

}  // namespace sunder::solver
