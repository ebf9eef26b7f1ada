// SPDX-License-Identifier: Apache-2.0
// Where the entries of a body's tangent are in the order of its factor, and the factor's
// elimination tree: found once, for a new tangent changes numbers only.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "body/hyperelastic.hpp"
#include "linear_algebra/supernodes.hpp"

namespace sunder::fem {

class TangentPattern {
 public:
  explicit TangentPattern(const Problem& problem);

  /// df/du over the unknowns in the order of supernodes(), lower triangle, anchors included, with
  /// `inertia` [N/mm] added to every diagonal entry. Equations of gripped unknowns are x = b;
  /// unknowns that no live element reaches are frozen: 1 N/mm on the diagonal.
  [[nodiscard]] linear_algebra::SparseMatrix tangent(const HyperelasticBody& body,
                                                     std::span<const double> u, Tangent kind,
                                                     double inertia = 0) const;
  [[nodiscard]] const std::shared_ptr<const linear_algebra::Supernodes>& supernodes() const {
    return supernodes_;
  }
  /// Of a matrix that tangent() made, by unknown; 0 at gripped ones.
  [[nodiscard]] Eigen::VectorXd diagonal(const linear_algebra::SparseMatrix& tangent) const;

 private:
  const Problem& problem_;
  std::vector<std::uint8_t> gripped_;  // per unknown
  std::shared_ptr<const linear_algebra::Supernodes> supernodes_;
  linear_algebra::SparseMatrix zero_;  // the diagonal is the first entry of a column
  std::vector<Index> places_;          // of each element's lower triangle; kNone: not among them
};

}  // namespace sunder::fem
