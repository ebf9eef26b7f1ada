// SPDX-License-Identifier: Apache-2.0
// Numeric part of a supernodal sparse Cholesky factor.
#pragma once

#include <atomic>
#include <span>

#include "linear_algebra/shared_loop.hpp"
#include "linear_algebra/supernodes.hpp"

namespace sunder::linear_algebra {

/// How a factor, or what it is to give, is computed. The bits do not depend on it.
struct FactorWork {
  int threads = 1;                          ///< share subtrees, large panels' rows, right sides
  const std::atomic<bool>* stop = nullptr;  ///< once true, the work is given up
  SparseMatrix* ordered = nullptr;          ///< receives the matrix in the factor's order
};

/// Of what everybody waits for: by all processors.
[[nodiscard]] inline FactorWork work_at_once() { return {.threads = machine_threads()}; }
/// Of what is computed beside the frames: by half of them, the others are the host's.
[[nodiscard]] inline FactorWork work_beside(const std::atomic<bool>& stop) {
  return {.threads = background_threads(), .stop = &stop};
}

/// Writes the panels of L, whatever they held, of a matrix given in the factor's order by its lower
/// triangle. Left-looking (Ng and Peyton 1993): a panel collects the matrix's columns, subtracts
/// what each descendant panel that reaches into it contributes, and is factored as a dense block.
/// Every entry is summed in the same order whatever the number of threads. False: the matrix is not
/// positive definite in double precision, or the work was given up.
[[nodiscard]] bool factorise(const Supernodes& nodes, const SparseMatrix& matrix,
                             const FactorWork& work, std::span<double> values);

}  // namespace sunder::linear_algebra
