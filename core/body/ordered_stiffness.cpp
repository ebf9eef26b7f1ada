// SPDX-License-Identifier: Apache-2.0
#include "body/ordered_stiffness.hpp"

#include <algorithm>
#include <array>

#include "body/element.hpp"

namespace sunder::fem {
namespace {

/// Calls body(i, j, dof, other) for each pair of an element's unknowns once.
template <class Body>
void for_pairs(const Problem& problem, Index element, Body&& body) {
  std::array<Index, 12> dofs;
  for (int i = 0; i < 12; ++i) dofs[i] = problem.dof(problem.mesh().tets[element][i / 3], i % 3);
  for (int j = 0; j < 12; ++j) {
    for (int i = 0; i < 12; ++i) {
      if (dofs[j] != kNone && dofs[i] >= dofs[j]) body(i, j, dofs[i], dofs[j]);
    }
  }
}

}  // namespace

OrderedStiffness::OrderedStiffness(const Problem& problem,
                                   std::shared_ptr<const linear_algebra::Supernodes> nodes,
                                   const linear_algebra::SparseMatrix& intact)
    : problem_(problem),
      nodes_(std::move(nodes)),
      around_(problem.mesh()),
      scale_(problem.mesh().tets.size(), 1.0),
      changed_(static_cast<std::size_t>(intact.nonZeros()), 0) {
  const linear_algebra::SparseMatrix upper = intact.transpose();  // a transpose sorts
  matrix_ = upper.transpose();
}

/// Where the entry of a pair is among the matrix's values.
Index OrderedStiffness::entry(Index dof, Index other) const {
  const auto [column, row] = std::minmax(nodes_->place[dof], nodes_->place[other]);
  const Index* rows = matrix_.innerIndexPtr();
  const Index* begin = rows + matrix_.outerIndexPtr()[column];
  const Index* end = rows + matrix_.outerIndexPtr()[column + 1];
  const Index* at = std::lower_bound(begin, end, row);
  return at != end && *at == row ? static_cast<Index>(at - rows) : kNone;
}

void OrderedStiffness::follow(const DamagedBody& body) {
  const std::span<const double> now = body.scale();
  const auto came_back = [&] {
    for (std::size_t e = 0; e < scale_.size(); ++e) {
      if (now[e] > scale_[e]) return true;
    }
    return false;
  };
  if (came_back()) begin_anew();
  std::vector<Index> around;
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    if (now[e] == scale_[e]) continue;
    scale_[e] = now[e];
    clear(e);
    for (Index n : problem_.mesh().tets[e]) {
      const auto elements = around_.of(n);
      around.insert(around.end(), elements.begin(), elements.end());
    }
  }
  if (around.empty()) return;
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  for (Index e : around) add(e, body.scale()[e]);
  add_anchors();
  for (Index i : entries_) changed_[i] = kEver;
  entries_.clear();
}

/// Back to the intact one, whose sums are in another order.
void OrderedStiffness::begin_anew() {
  for (const auto& [entry, value] : intact_) {
    matrix_.valuePtr()[entry] = value;
    changed_[entry] = 0;
  }
  intact_.clear();
  scale_.assign(scale_.size(), 1.0);
}

void OrderedStiffness::clear(Index element) {
  for_pairs(problem_, element, [&](int, int, Index dof, Index other) {
    const Index i = entry(dof, other);
    if (changed_[i] & kNow) return;
    if (!changed_[i]) intact_.emplace_back(i, matrix_.valuePtr()[i]);
    changed_[i] |= kNow;
    entries_.push_back(i);
    matrix_.valuePtr()[i] = 0;
  });
}

void OrderedStiffness::add(Index element, double scale) {
  ElementMatrix k = element_stiffness(problem_, element);
  k *= scale;
  for_pairs(problem_, element, [&](int i, int j, Index dof, Index other) {
    const Index at = entry(dof, other);
    if (changed_[at] & kNow) matrix_.valuePtr()[at] += k(i, j);
  });
}

void OrderedStiffness::add_anchors() {
  for (Index dof : problem_.anchored_dofs()) {
    const Index i = entry(dof, dof);
    if (i != kNone && (changed_[i] & kNow)) matrix_.valuePtr()[i] += problem_.anchor_stiffness();
  }
}

linear_algebra::Factor OrderedStiffness::factor(const linear_algebra::FactorWork& work) const {
  return {nodes_, matrix_, work};
}

std::size_t OrderedStiffness::bytes() const {
  return static_cast<std::size_t>(matrix_.nonZeros()) * (sizeof(double) + sizeof(Index) + 1) +
         problem_.mesh().tets.size() * 4 * sizeof(Index);
}

}  // namespace sunder::fem
