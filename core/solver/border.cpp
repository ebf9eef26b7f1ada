// SPDX-License-Identifier: Apache-2.0
#include "solver/border.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "body/element.hpp"
#include "body/pools.hpp"
#include "material/linear.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
/// The least unknown at which the event's elements, before it or after it, or its ties act.
Index Border::first_changed(const fem::Forms& forms, const fem::Event& event,
                            std::span<const Index> patches) {
  Index first = unknowns_.count();
  const auto acts = [&](const std::array<Index, 4>& corners) {
    for (Index column : own(forms, corners)) {
      if (column != kNone) first = std::min(first, column);
    }
  };
  for (const fem::Coming& c : event.come) {
    const auto before = corners_.find(c.element);
    if (before != corners_.end()) acts(before->second);
    acts(c.form.corners);
    corners_[c.element] = c.form.corners;
  }
  for (Index e : event.leave) {
    const auto at = corners_.find(e);
    if (at != corners_.end()) acts(at->second);
  }
  // Of a patch, what one element changes acts at the new nodes of all.
  for (Index patch : patches) {
    for (Index e : forms.problem().pools()->elements(patch)) {
      const auto at = corners_.find(e);
      if (at != corners_.end()) acts(at->second);
    }
  }
  for (const fem::Tie& tie : event.ties) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index column = unknowns_.unknown(tie.node - forms.problem().node_count(), axis);
      if (column != kNone) first = std::min(first, column);
    }
  }
  return first;
}

/// The offsets of an element's corners, by corner and axis; kNone: it has none there.
std::array<Index, 12> Border::own(const fem::Forms& forms,
                                  const std::array<Index, 4>& corners) const {
  std::array<Index, 12> own;
  for (int i = 0; i < 12; ++i) {
    const Index added = corners[static_cast<std::size_t>(i / 3)] - forms.problem().node_count();
    own[static_cast<std::size_t>(i)] = added < 0 ? kNone : unknowns_.unknown(added, i % 3);
  }
  return own;
}

bool Border::follow(const fem::Forms& forms, const fem::Event& event, DifferenceBasis& basis,
                    const linear_algebra::RowMajor& g, const linear_algebra::RowMajor& m,
                    const Over& over) {
  const Index before = unknowns_.count();
  unknowns_.follow(forms);
  for (Eigen::VectorXd* v : {&load_, &d_, &lack_, &step_}) v->setZero(unknowns_.count());
  if (empty() && event.come.empty()) return true;
  const bool anew = over.anew || before > unknowns_.count() || before != l_.rows();
  const Index changed = first_changed(forms, event, over.patches);
  const Index from = anew ? 0 : std::min(changed, before);
  const Eigen::Index rows = anew ? 0 : rows_of_h_;
  resize(over.columns);
  assemble(forms, basis, over.of_basis, from);
  multiply(g, m, over, from, rows);
  rows_of_h_ = over.columns;
  return factor(from);
}

/// What is there stays.
void Border::resize(Eigen::Index rows) {
  e_.resize(static_cast<std::size_t>(size()));
  h_.conservativeResize(rows, size());
  f_.conservativeResize(size(), size());
  l_.conservativeResize(size(), size());
}

/// Columns of E and rows of F from `from` on; F is kept up to its diagonal.
void Border::assemble(const fem::Forms& forms, DifferenceBasis& basis,
                      std::span<const Index> of_basis, Index from) {
  for (std::size_t j = static_cast<std::size_t>(from); j < e_.size(); ++j) e_[j].clear();
  f_.bottomRows(size() - from).setZero();
  const Index first = forms.problem().node_count();
  for (const auto& [element, form] : forms.came()) {
    const bool at_new = std::ranges::any_of(form.corners, [&](Index n) { return n >= first; });
    if (at_new && form.share > 0) add(forms, form, basis, of_basis, from);
  }
  if (forms.problem().pools()) add_patches(forms, basis, of_basis, from);
  add_ties(from);
}

/// kappa / V_p b_p b_p^T of the patches with an element at new nodes.
void Border::add_patches(const fem::Forms& forms, DifferenceBasis& basis,
                         std::span<const Index> of_basis, Index from) {
  const Problem& problem = forms.problem();
  std::vector<Index> elements, patches;
  for (const auto& [element, form] : forms.came()) {
    for (Index column : own(forms, form.corners)) {
      if (column >= from && form.share > 0) elements.push_back(element);  // kNone is less
    }
  }
  problem.pools()->of(elements, patches);
  for (Index patch : patches) {
    for (const std::vector<Index>& part : forms.pools()->parts_of(*problem.pools(), patch)) {
      add_patch(forms, part, basis, of_basis, from);
    }
  }
}

void Border::add_patch(const fem::Forms& forms, std::span<const Index> elements,
                       DifferenceBasis& basis, std::span<const Index> of_basis, Index from) {
  const auto share = [&](Index e) { return forms.share(e); };
  std::vector<fem::StiffnessPart> parts;
  fem::append_pressure(forms.problem(), elements, 0, share, parts);
  on_old_.clear();
  on_new_.clear();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::array<Index, 4>& corners = forms.corners(elements[i]);
    basis.coordinates(forms.parents(corners), parts[i].u, rows_, y_);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const Index row = of_basis[static_cast<std::size_t>(rows_[r])];
      on_old_[row] += y_(static_cast<Eigen::Index>(r), 0);
    }
    const std::array<Index, 12> columns = own(forms, corners);
    for (int j = 0; j < 12; ++j) {
      const Index column = columns[static_cast<std::size_t>(j)];
      if (column != kNone) on_new_[column] += parts[i].u(j, 0);
    }
  }
  for (const auto& [column, value] : on_new_) {
    if (column < from) continue;
    for (const auto& [row, of_row] : on_old_) add_to_e(column, row, of_row * value);
    for (const auto& [other, of_other] : on_new_) {
      if (other <= column) f_(column, other) += value * of_other;
    }
  }
}

void Border::add_to_e(Index column, Index row, double value) {
  auto& entries = e_[static_cast<std::size_t>(column)];
  const auto there = std::ranges::find(entries, row, &Entry::row);
  if (there == entries.end()) {
    entries.push_back({row, value});
  } else {
    there->value += value;
  }
}

/// Ties and springs between new nodes and their parents join F.
void Border::add_ties(Index from) {
  for (std::size_t i = 0; i < unknowns_.nodes().size(); ++i) {
    const fem::NewNode& node = unknowns_.nodes()[i];
    for (int axis = 0; axis < 3; ++axis) {
      const Index column = unknowns_.unknown(static_cast<Index>(i), axis);
      if (column < from) continue;  // kNone too
      f_(column, column) += node.tie;
      for (int other = 0; other <= axis; ++other) {
        const Index row = unknowns_.unknown(static_cast<Index>(i), other);
        if (row != kNone) f_(column, row) += node.spring[axis] * node.spring[other];
      }
    }
  }
}

/// An element's K = W W^T, W = share^1/2 B^T L V^1/2, joins E and F.
void Border::add(const fem::Forms& forms, const fem::Form& form, DifferenceBasis& basis,
                 std::span<const Index> of_basis, Index from) {
  const std::array<Index, 12> columns = own(forms, form.corners);
  if (*std::ranges::max_element(columns) < from) return;
  const fem::UpdateFactor w = fem::update_factor(form.shape, form.law, 0) * std::sqrt(form.share);
  basis.coordinates(forms.parents(form.corners), w, rows_, y_);
  for (int j = 0; j < 12; ++j) {
    const Index column = columns[static_cast<std::size_t>(j)];
    if (column < from) continue;  // kNone too
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const Index row = of_basis[static_cast<std::size_t>(rows_[r])];
      add_to_e(column, row, y_.row(static_cast<Eigen::Index>(r)).head<6>().dot(w.row(j)));
    }
    for (int i = 0; i < 12; ++i) {
      const Index other = columns[static_cast<std::size_t>(i)];
      if (other != kNone && other <= column) f_(column, other) += w.row(i).dot(w.row(j));
    }
  }
}

/// N = E + M G E and H = G N: columns from `from` on, and of those before the rows from `rows` on.
void Border::multiply(const linear_algebra::RowMajor& g, const linear_algebra::RowMajor& m,
                      const Over& over, Index from, Eigen::Index rows) {
  const Eigen::Index n = over.columns, k = std::min(over.changed, n), added = size() - from;
  h_.rightCols(added).setZero();
  if (n > rows) h_.bottomLeftCorner(n - rows, from).setZero();
  for (Index j = 0; j < size(); ++j) {
    const Eigen::Index first = j < from ? rows : 0;
    for (const Entry& at : e_[static_cast<std::size_t>(j)]) {  // G is symmetric
      h_.col(j).tail(n - first) += at.value * g.row(at.row).segment(first, n - first).transpose();
    }
  }
  n_.conservativeResize(k, size());
  if (k == 0) return;
  n_.rightCols(added).noalias() = m.topLeftCorner(k, k) * h_.topRightCorner(k, added);
  h_.rightCols(added).noalias() += g.topLeftCorner(n, k) * n_.rightCols(added);
  if (n > rows) {
    h_.bottomLeftCorner(n - rows, from).noalias() +=
        g.block(rows, 0, n - rows, k) * n_.leftCols(from);
  }
}

/// S = F - E^T H from row `from` on, and its Cholesky factor by a border of the one before.
bool Border::factor(Index from) {
  const Eigen::Index kept = from, added = size() - from;
  if (added == 0) return true;
  Eigen::MatrixXd s(added, size());  // up to the diagonal
  for (Eigen::Index i = 0; i < added; ++i) {
    const auto row = static_cast<Index>(kept + i);
    for (Index j = 0; j <= row; ++j) {
      double sum = f_(row, j);
      for (const Entry& at : e_[static_cast<std::size_t>(row)]) sum -= at.value * h_(at.row, j);
      s(i, j) = sum;
    }
    // No element there (any more): its offset is 0.
    if (f_(row, row) == 0) s(i, row) = 1;
  }
  if (kept > 0) {
    Eigen::MatrixXd x = s.leftCols(kept).transpose();
    l_.topLeftCorner(kept, kept).triangularView<Eigen::Lower>().solveInPlace(x);
    l_.bottomLeftCorner(added, kept) = x.transpose();
    s.rightCols(added).triangularView<Eigen::Lower>() -= x.transpose() * x;
  }
  const Eigen::LLT<Eigen::MatrixXd> corner(s.rightCols(added).selfadjointView<Eigen::Lower>());
  l_.bottomRightCorner(added, added) = corner.matrixL();
  return corner.info() == Eigen::Success && l_.bottomRows(added).allFinite();
}

/// d = S^-1 d.
void Border::solve(Eigen::VectorXd& d) const {
  l_.triangularView<Eigen::Lower>().solveInPlace(d);
  l_.triangularView<Eigen::Lower>().transpose().solveInPlace(d);
}

/// d -= N^T p.
void Border::subtract_transposed(const Eigen::VectorXd& p, Eigen::VectorXd& d) const {
  for (std::size_t j = 0; j < e_.size(); ++j) {
    for (const Entry& at : e_[j]) d[static_cast<Eigen::Index>(j)] -= at.value * p[at.row];
  }
  d.noalias() -= n_.transpose() * p.head(n_.rows());
}

/// x += sign N d.
void Border::add_product(const Eigen::VectorXd& d, double sign, Eigen::VectorXd& x) const {
  for (std::size_t j = 0; j < e_.size(); ++j) {
    const double by = sign * d[static_cast<Eigen::Index>(j)];
    for (const Entry& at : e_[j]) x[at.row] += by * at.value;
  }
  x.head(n_.rows()).noalias() += sign * (n_ * d);
}

void Border::add_to_grips(Eigen::MatrixXd& compliance) const {
  const Eigen::Index g = compliance.rows();
  Eigen::MatrixXd t(size(), g);
  for (Eigen::Index i = 0; i < g; ++i) t.col(i) = h_.row(grips_[static_cast<std::size_t>(i)]);
  l_.triangularView<Eigen::Lower>().solveInPlace(t);
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
  subtract_transposed(p, d_);
  solve(d_);
  add_product(d_, -1, x);
}

void Border::add_lack(const Eigen::VectorXd& v, Eigen::VectorXd& lack) {
  lack_ = load_;
  for (std::size_t j = 0; j < e_.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    for (const Entry& at : e_[j]) {
      lack[at.row] -= at.value * d_[column];
      lack_[column] -= at.value * v[at.row];
    }
  }
  lack_.noalias() -= f_.selfadjointView<Eigen::Lower>() * d_;
}

double Border::correct(const Eigen::VectorXd& by_lack, Eigen::VectorXd& x, Eigen::VectorXd& moved) {
  subtract_transposed(by_lack, lack_);  // H^T = N^T G, and of N few rows are not 0
  step_ = lack_;
  solve(step_);
  d_ += step_;
  add_product(step_, -1, x);
  for (std::size_t i = 0; i < grips_.size(); ++i) {
    moved[static_cast<Eigen::Index>(i)] -= h_.row(grips_[i]).dot(step_);
  }
  return lack_.dot(step_);
}

void Border::follow_grips(const Eigen::VectorXd& forces, Eigen::VectorXd& x) {
  step_.setZero(size());
  for (std::size_t i = 0; i < grips_.size(); ++i) {
    step_ += forces[static_cast<Eigen::Index>(i)] * h_.row(grips_[i]).transpose();
  }
  solve(step_);
  d_ -= step_;
  add_product(step_, 1, x);
}

std::size_t Border::bytes() const {
  const Eigen::Index doubles = f_.size() + n_.size() + h_.size() + l_.size();
  return empty() ? 0 : static_cast<std::size_t>(doubles) * sizeof(double);
}

}  // namespace sunder::solver
