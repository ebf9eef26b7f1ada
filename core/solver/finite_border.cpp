// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_border.hpp"

#include <algorithm>

namespace sunder::solver {
namespace {

// Of S, squared diagonal of its factor against C: what is left holds by rounding alone.
constexpr double kLeastOfBorder = 1e-10;

}  // namespace

FiniteBorder::FiniteBorder(const Problem& problem)
    : now_(&problem),
      own_(problem.dof_count()),
      corners_(problem.mesh().tets.begin(), problem.mesh().tets.end()) {}

void FiniteBorder::part(const Problem& now, std::span<const double> mass) {
  now_ = &now;
  mass_ = mass;
  from_.assign(static_cast<std::size_t>(now.dof_count() - own_), kNone);
  for (Index e = 0; e < now.tet_count(); ++e) {
    const auto& is = now.mesh().tets[static_cast<std::size_t>(e)];
    for (std::size_t a = 0; a < 4; ++a) {
      if (is[a] == corners(e)[a]) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const Index own = now.dof(is[a], axis);
        if (own != kNone)
          from_[static_cast<std::size_t>(own - own_)] = now.dof(corners(e)[a], axis);
      }
    }
  }
}

/// Of the patches with an element at new nodes: each is stiff along one vector over all its nodes.
void FiniteBorder::add_patches(const Base& base, std::vector<Column>& b, Eigen::MatrixXd& c) const {
  std::vector<Index> elements, patches, glued, offset;
  for (Index e = 0; e < now_->tet_count(); ++e) {
    const bool out = base.out[static_cast<std::size_t>(e)] != 0;
    if (!out && now_->mesh().tets[static_cast<std::size_t>(e)] != corners(e)) elements.push_back(e);
  }
  now_->pools()->of(elements, patches);
  for (Index patch : patches) {
    const fem::PatchTangent k = base.patch(patch);
    if (k.b.size() == 0) continue;
    glued.clear();
    offset.clear();
    const auto coupled = [&](Index d) {
      return d != kNone && base.coupled[static_cast<std::size_t>(d)] ? d : kNone;
    };
    for (Index n : now_->pools()->nodes(*now_, patch)) {
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = now_->dof(n, axis);
        glued.push_back(coupled(this->glued(d)));
        offset.push_back(d < own_ || coupled(d) == kNone ? kNone : d - own_);
      }
    }
    for (std::size_t j = 0; j < offset.size(); ++j) {
      if (offset[j] == kNone) continue;
      for (std::size_t i = 0; i < offset.size(); ++i) {
        const double value =
            k.factor * k.b[static_cast<Eigen::Index>(i)] * k.b[static_cast<Eigen::Index>(j)];
        if (glued[i] != kNone) b[static_cast<std::size_t>(offset[j])][glued[i]] += value;
        if (offset[i] != kNone) c(offset[i], offset[j]) += value;
      }
    }
  }
}

bool FiniteBorder::follow(const Base& base, const Eigen::MatrixXd& m,
                          std::span<const Index> touched) {
  const Index count = size();
  std::vector<Column> b(from_.size());
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(count, count);
  for (Index e = 0; e < now_->tet_count(); ++e) {
    const auto& is = now_->mesh().tets[static_cast<std::size_t>(e)];
    if (base.out[static_cast<std::size_t>(e)] || is == corners(e)) continue;
    const fem::ElementMatrix k = base.tangent(e);
    std::array<Index, 12> glued, offset;  // unknown of the base; new one, from 0
    for (int i = 0; i < 12; ++i) {
      const auto a = static_cast<std::size_t>(i / 3);
      const auto coupled = [&](Index d) {
        return d != kNone && base.coupled[static_cast<std::size_t>(d)] ? d : kNone;
      };
      const std::size_t at = static_cast<std::size_t>(i);
      glued[at] = coupled(now_->dof(corners(e)[a], i % 3));
      const Index own = is[a] == corners(e)[a] ? kNone : coupled(now_->dof(is[a], i % 3));
      offset[at] = own == kNone ? kNone : own - own_;
    }
    for (std::size_t j = 0; j < 12; ++j) {
      if (offset[j] == kNone) continue;
      for (std::size_t i = 0; i < 12; ++i) {
        const double value = k(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        if (glued[i] != kNone) b[static_cast<std::size_t>(offset[j])][glued[i]] += value;
        if (offset[i] != kNone) c(offset[i], offset[j]) += value;
      }
    }
  }
  if (now_->pools()) add_patches(base, b, c);
  for (Index i = 0; i < count; ++i) {
    const Index from = from_[static_cast<std::size_t>(i)];
    if (c(i, i) == 0) {  // nothing moves it but the node that it parts from
      c(i, i) = 1;
      continue;
    }
    if (mass_.empty()) continue;
    const double inertia = base.inertia * mass_[static_cast<std::size_t>(own_ + i)];
    b[static_cast<std::size_t>(i)][from] += inertia;
    c(i, i) += inertia;
  }
  // Columns that are as they were keep what the base has made of them.
  std::vector<Index> fresh;
  for (Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (at >= b_.size() || b_[at] != b[at]) fresh.push_back(i);
  }
  b_ = std::move(b);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(own_, static_cast<Eigen::Index>(fresh.size()));
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    for (const auto& [row, value] : b_[static_cast<std::size_t>(fresh[i])]) {
      columns(row, static_cast<Eigen::Index>(i)) = value;
    }
  }
  if (!fresh.empty()) base.solve(columns);
  z_.conservativeResize(own_, count);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    z_.col(fresh[i]) = columns.col(static_cast<Eigen::Index>(i));
  }
  Eigen::MatrixXd s = c;
  for (Index i = 0; i < count; ++i) {
    for (const auto& [row, value] : b_[static_cast<std::size_t>(i)])
      s.row(i) -= value * z_.row(row);
  }
  z_touched_.resize(static_cast<Eigen::Index>(touched.size()), count);
  for (std::size_t i = 0; i < touched.size(); ++i) {
    z_touched_.row(static_cast<Eigen::Index>(i)) = z_.row(touched[i]);
  }
  if (!touched.empty()) s -= z_touched_.transpose() * (m * z_touched_);
  s_.compute((s + s.transpose()) / 2);
  if (s_.info() != Eigen::Success) return false;
  const Eigen::ArrayXd left = s_.matrixLLT().diagonal().array().square();
  return (left > kLeastOfBorder * c.diagonal().array()).all();
}

void FiniteBorder::gather(const Eigen::VectorXd& forces, Eigen::VectorXd& on_base) const {
  on_base = forces.head(own_);
  for (std::size_t i = 0; i < from_.size(); ++i) {
    if (from_[i] != kNone) on_base[from_[i]] += forces[own_ + static_cast<Index>(i)];
  }
}

void FiniteBorder::solve(const Eigen::VectorXd& forces, const Eigen::VectorXd& on_base,
                         const Eigen::MatrixXd& m, Eigen::VectorXd& p, Eigen::VectorXd& d) const {
  d = forces.tail(size());
  d.noalias() -= z_.transpose() * on_base;
  if (p.size() > 0) d.noalias() -= z_touched_.transpose() * (m * p);
  s_.solveInPlace(d);
  if (p.size() > 0) p.noalias() -= z_touched_ * d;
}

void FiniteBorder::add(const Eigen::VectorXd& d, Eigen::VectorXd& x) const {
  x.noalias() -= z_ * d;
  x.conservativeResize(own_ + size());
  for (std::size_t i = 0; i < from_.size(); ++i) {
    const auto at = static_cast<Index>(i);
    x[own_ + at] = d[at] + (from_[i] == kNone ? 0.0 : x[from_[i]]);
  }
}

}  // namespace sunder::solver
