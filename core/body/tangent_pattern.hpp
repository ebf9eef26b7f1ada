// SPDX-License-Identifier: Apache-2.0
// Where the entries of a body's tangent are in the order of its factor, and the factor's
// elimination tree: found once, for a new tangent changes numbers only.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "body/pooled_law.hpp"
#include "linear_algebra/supernodes.hpp"

namespace sunder::fem {

/// What the inertia of a step of time adds to the tangent's diagonal [N/mm].
struct Inertia {
  double factor = 0;                  ///< [N/mm], with masses [1/s^2]
  std::span<const double> mass = {};  ///< per unknown [t]; empty: 1

  [[nodiscard]] double of(Index unknown) const {
    return mass.empty() ? factor : factor * mass[static_cast<std::size_t>(unknown)];
  }
};

class TangentPattern {
 public:
  explicit TangentPattern(const Problem& problem);

  /// df/du over the unknowns in the order of supernodes(), lower triangle, anchors included, with
  /// `inertia` added to the diagonal. Equations of gripped unknowns are x = b; unknowns that no
  /// live element reaches have their inertia alone, without masses 1 N/mm besides: they are frozen.
  [[nodiscard]] linear_algebra::SparseMatrix tangent(const HyperelasticBody& body,
                                                     std::span<const double> u, Tangent kind,
                                                     const Inertia& inertia = {}) const;
  /// The same with these pressures and stiffnesses of patches of pooled volume.
  [[nodiscard]] linear_algebra::SparseMatrix tangent(const HyperelasticBody& body,
                                                     std::span<const double> u, Tangent kind,
                                                     const PatchVolumes& volumes,
                                                     const Inertia& inertia = {}) const;
  /// The same of any 12 x 12 of live elements, and of what patches of pooled volume add: one each;
  /// empty: none.
  [[nodiscard]] linear_algebra::SparseMatrix tangent(
      const HyperelasticBody& body, const std::function<ElementMatrix(Index)>& of_element,
      std::span<const PatchTangent> patches, const Inertia& inertia = {}) const;
  [[nodiscard]] const std::shared_ptr<const linear_algebra::Supernodes>& supernodes() const {
    return supernodes_;
  }
  /// Of a matrix that tangent() made, by unknown; 0 at gripped ones.
  [[nodiscard]] Eigen::VectorXd diagonal(const linear_algebra::SparseMatrix& tangent) const;

 private:
  [[nodiscard]] Index place_of(Index one, Index other) const;
  void add_patches(const HyperelasticBody& body, std::span<const PatchTangent> patches,
                   double* values) const;

  const Problem& problem_;
  std::vector<std::uint8_t> gripped_;  // per unknown
  std::shared_ptr<const linear_algebra::Supernodes> supernodes_;
  linear_algebra::SparseMatrix zero_;  // the diagonal is the first entry of a column
  std::vector<Index> places_;          // of each element's lower triangle; kNone: not among them
  std::vector<Index> patch_places_;    // the same of each patch, one after the other
};

/// Found when it is first asked for: a base that follows what parts needs none.
class PatternOnDemand {
 public:
  explicit PatternOnDemand(const Problem& problem) : problem_(problem) {}
  [[nodiscard]] const TangentPattern& get() {
    if (!pattern_) pattern_.emplace(problem_);
    return *pattern_;
  }

 private:
  const Problem& problem_;
  std::optional<TangentPattern> pattern_;
};

}  // namespace sunder::fem
