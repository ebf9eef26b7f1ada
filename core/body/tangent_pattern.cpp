// SPDX-License-Identifier: Apache-2.0
#include "body/tangent_pattern.hpp"

#include <algorithm>
#include <array>

#include "body/assembly.hpp"
#include "body/stiffness_factor.hpp"

namespace sunder::fem {
namespace {

constexpr std::size_t kPairs = 78;  // of an element's twelve unknowns, each once

/// Calls body(i, j) for each, in the order of places_.
template <class Body>
void for_pairs(Body&& body) {
  for (int j = 0; j < 12; ++j) {
    for (int i = j; i < 12; ++i) body(i, j);
  }
}

}  // namespace

TangentPattern::TangentPattern(const Problem& problem)
    : problem_(problem), gripped_(static_cast<std::size_t>(problem.dof_count()), 0) {
  for (Index d : problem.gripped_dofs()) gripped_[d] = 1;
  const linear_algebra::SparseMatrix entries =
      assemble_elements(problem, [](Index) -> ElementMatrix { return ElementMatrix::Zero(); });
  linear_algebra::SparseMatrix ordered;
  supernodes_ = std::make_shared<const linear_algebra::Supernodes>(
      linear_algebra::find_supernodes(entries, elimination_order(problem), ordered));
  const linear_algebra::SparseMatrix upper = ordered.transpose();  // a transpose sorts
  zero_ = upper.transpose();
  std::fill_n(zero_.valuePtr(), zero_.nonZeros(), 0.0);
  places_.reserve(kPairs * problem.mesh().tets.size());
  for (Index e = 0; e < problem.tet_count(); ++e) {
    std::array<Index, 12> dofs;
    for (int i = 0; i < 12; ++i) dofs[i] = problem.dof(problem.mesh().tets[e][i / 3], i % 3);
    for_pairs([&](int i, int j) {
      const bool known =
          dofs[i] == kNone || dofs[j] == kNone || gripped_[dofs[i]] || gripped_[dofs[j]];
      if (known) {
        places_.push_back(kNone);
        return;
      }
      const auto [column, row] =
          std::minmax(supernodes_->place[dofs[i]], supernodes_->place[dofs[j]]);
      const Index* rows = zero_.innerIndexPtr();
      const Index* at = std::lower_bound(rows + zero_.outerIndexPtr()[column],
                                         rows + zero_.outerIndexPtr()[column + 1], row);
      places_.push_back(static_cast<Index>(at - rows));
    });
  }
}

linear_algebra::SparseMatrix TangentPattern::tangent(const HyperelasticBody& body,
                                                     std::span<const double> u, Tangent kind,
                                                     const Inertia& inertia) const {
  return tangent(
      body, [&](Index e) { return element_tangent(body, e, u, kind); }, inertia);
}

linear_algebra::SparseMatrix TangentPattern::tangent(
    const HyperelasticBody& body, const std::function<ElementMatrix(Index)>& of_element,
    const Inertia& inertia) const {
  linear_algebra::SparseMatrix of = zero_;
  double* values = of.valuePtr();
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    if (!body.live(e)) continue;
    const ElementMatrix k = of_element(e);
    const Index* place = places_.data() + kPairs * static_cast<std::size_t>(e);
    for_pairs([&](int i, int j) {
      if (*place != kNone) values[*place] += k(i, j);
      ++place;
    });
  }
  const auto diagonal = [&](Index d) -> double& {
    return values[of.outerIndexPtr()[supernodes_->place[d]]];
  };
  for (Index d : problem_.anchored_dofs()) diagonal(d) += problem_.anchor_stiffness();
  for (Index d = 0; d < problem_.dof_count(); ++d) {
    double& entry = diagonal(d);
    if (gripped_[d] || (entry == 0 && inertia.mass.empty())) entry = 1;  // the others are frozen
    if (!gripped_[d]) entry += inertia.of(d);
  }
  return of;
}

Eigen::VectorXd TangentPattern::diagonal(const linear_algebra::SparseMatrix& tangent) const {
  Eigen::VectorXd of(problem_.dof_count());
  for (Index d = 0; d < problem_.dof_count(); ++d) {
    of[d] = gripped_[d] ? 0 : tangent.valuePtr()[tangent.outerIndexPtr()[supernodes_->place[d]]];
  }
  return of;
}

}  // namespace sunder::fem
