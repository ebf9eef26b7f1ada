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

/// The same of the unknowns of a patch.
template <class Body>
void for_patch_pairs(const Problem& problem, const Pools& pools, Index patch, Body&& body) {
  std::vector<Index> dofs;
  for (Index n : pools.nodes(problem, patch)) {
    for (int axis = 0; axis < 3; ++axis) dofs.push_back(problem.dof(n, axis));
  }
  for (std::size_t j = 0; j < dofs.size(); ++j) {
    for (std::size_t i = j; i < dofs.size(); ++i) body(dofs[i], dofs[j]);
  }
}

}  // namespace

TangentPattern::TangentPattern(const Problem& problem)
    : problem_(problem), gripped_(static_cast<std::size_t>(problem.dof_count()), 0) {
  for (Index d : problem.gripped_dofs()) gripped_[d] = 1;
  linear_algebra::SparseMatrix entries =
      assemble_elements(problem, [](Index) -> ElementMatrix { return ElementMatrix::Zero(); });
  if (problem.pools()) entries += assemble_pressure(problem, {});
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
    for_pairs([&](int i, int j) { places_.push_back(place_of(dofs[i], dofs[j])); });
  }
  const Index patches = problem.pools() ? problem.pools()->count() : 0;
  for (Index p = 0; p < patches; ++p) {
    for_patch_pairs(problem, *problem.pools(), p,
                    [&](Index one, Index other) { patch_places_.push_back(place_of(one, other)); });
  }
}

/// Those of split patches are found where they are needed: they are parts of the problem's own.
void TangentPattern::add_patches(const HyperelasticBody& body,
                                 std::span<const PatchTangent> patches, double* values) const {
  const Index* made = patch_places_.data();
  const Index whole = problem_.pools() ? problem_.pools()->count() : 0;
  std::vector<Index> found;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const PatchTangent& patch = patches[p];
    const auto id = static_cast<Index>(p);
    const Index* place = made;
    if (id < whole) {
      const auto count = 3 * problem_.pools()->nodes(problem_, id).size();
      made += count * (count + 1) / 2;
    }
    if (patch.b.size() == 0) continue;
    const bool split =
        id >= whole || body.pools()->elements(id).size() != problem_.pools()->elements(id).size();
    if (split) {
      found.clear();
      for_patch_pairs(problem_, *body.pools(), id,
                      [&](Index one, Index other) { found.push_back(place_of(one, other)); });
      place = found.data();
    }
    for (Eigen::Index j = 0; j < patch.b.size(); ++j) {
      for (Eigen::Index i = j; i < patch.b.size(); ++i, ++place) {
        if (*place != kNone) values[*place] += patch.factor * patch.b[i] * patch.b[j];
      }
    }
  }
}

/// Of an entry, among those of zero_; kNone: of a support or grip.
Index TangentPattern::place_of(Index one, Index other) const {
  if (one == kNone || other == kNone || gripped_[one] || gripped_[other]) return kNone;
  const auto [column, row] = std::minmax(supernodes_->place[one], supernodes_->place[other]);
  const Index* rows = zero_.innerIndexPtr();
  const Index* at = std::lower_bound(rows + zero_.outerIndexPtr()[column],
                                     rows + zero_.outerIndexPtr()[column + 1], row);
  return static_cast<Index>(at - rows);
}

linear_algebra::SparseMatrix TangentPattern::tangent(const HyperelasticBody& body,
                                                     std::span<const double> u, Tangent kind,
                                                     const Inertia& inertia) const {
  return tangent(body, u, kind, PatchVolumes(body, u), inertia);
}

linear_algebra::SparseMatrix TangentPattern::tangent(const HyperelasticBody& body,
                                                     std::span<const double> u, Tangent kind,
                                                     const PatchVolumes& volumes,
                                                     const Inertia& inertia) const {
  return tangent(
      body, [&](Index e) { return element_tangent(body, e, u, kind, volumes.pressure()); },
      patch_tangents(body, u, volumes.stiffness(), kind), inertia);
}

linear_algebra::SparseMatrix TangentPattern::tangent(
    const HyperelasticBody& body, const std::function<ElementMatrix(Index)>& of_element,
    std::span<const PatchTangent> patches, const Inertia& inertia) const {
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
  add_patches(body, patches, values);
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
