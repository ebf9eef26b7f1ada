// SPDX-License-Identifier: Apache-2.0
// Where a body's factor will have entries: known before any is computed, and so what it will take.
#pragma once

#include <memory>

#include "linear_algebra/supernodes.hpp"
#include "sunder/problem.hpp"

namespace sunder::fem {

struct Analysis {
  std::shared_ptr<const linear_algebra::Supernodes> nodes;
  linear_algebra::SparseMatrix
      ordered;  ///< the intact stiffness in the factor's order, lower triangle
  /// Of L: a triangular solve will read each once.
  [[nodiscard]] std::size_t entries() const { return nodes->value_begin.back(); }
};

/// In an order that the body's geometry gives.
[[nodiscard]] std::unique_ptr<const Analysis> analyse(const Problem& problem);

}  // namespace sunder::fem
