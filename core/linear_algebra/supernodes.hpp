// SPDX-License-Identifier: Apache-2.0
// Symbolic part of a supernodal sparse Cholesky factor: order, elimination tree, columns of equal
// structure gathered into panels (Ashcraft and Grimes 1989; Davis, "Direct Methods for Sparse
// Linear Systems", 2006, chapter 4).
#pragma once

#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

#include "linear_algebra/sparse_matrix.hpp"

namespace sunder::linear_algebra {

/// A count that several threads add to.
class SharedCount {
 public:
  SharedCount() = default;
  SharedCount(const SharedCount& other) : count_(other.get()) {}
  SharedCount& operator=(const SharedCount& other) {
    count_ = other.get();
    return *this;
  }
  ~SharedCount() = default;

  void add(std::size_t more) { count_.fetch_add(more, std::memory_order_relaxed); }
  [[nodiscard]] std::size_t get() const { return count_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::size_t> count_{0};
};

struct Supernodes {
  std::vector<Index> place;   ///< place[i]: row of L that unknown i became
  std::vector<Index> first;   ///< first column of each supernode; one past the end at the back
  std::vector<Index> of;      ///< supernode of each column of L
  std::vector<Index> parent;  ///< in the supernodal elimination tree, kNone: a root
  std::vector<std::size_t> row_begin;    ///< per supernode into rows; one more at the back
  std::vector<Index> rows;               ///< rows below the supernode's own columns, ascending
  std::vector<std::size_t> value_begin;  ///< per supernode: its panel; one more at the back

  mutable SharedCount solved;  ///< right sides that factors of this structure have solved for

  [[nodiscard]] Index count() const { return static_cast<Index>(parent.size()); }
  [[nodiscard]] Index width(Index s) const { return first[s + 1] - first[s]; }
  [[nodiscard]] std::span<const Index> below(Index s) const {
    return {rows.data() + row_begin[s], row_begin[s + 1] - row_begin[s]};
  }
  /// Rows of the panel: own columns, then below(s).
  [[nodiscard]] Index height(Index s) const {
    return width(s) + static_cast<Index>(row_begin[s + 1] - row_begin[s]);
  }
};

/// A symmetric matrix, lower triangle, whose row i becomes row place[i].
[[nodiscard]] SparseMatrix permute_lower(const SparseMatrix& lower,
                                         const std::vector<Index>& place);

/// The unknowns in the order `place` (empty: by minimum degree) but for a postorder of the
/// elimination tree. `permuted` receives the matrix in the factor's order, lower triangle.
[[nodiscard]] Supernodes find_supernodes(const SparseMatrix& lower, std::vector<Index> place,
                                         SparseMatrix& permuted);

}  // namespace sunder::linear_algebra
