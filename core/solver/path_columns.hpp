// SPDX-License-Identifier: Apache-2.0
// Columns of L^-1 P E_T, kept where they are not zero: supernode by supernode, one dense block of
// the columns that reach it. Columns are appended and taken back like a stack.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "linear_algebra/supernodal_cholesky.hpp"

namespace sunder::solver {

class PathColumns {
 public:
  explicit PathColumns(const linear_algebra::Supernodes& nodes);
  /// So that first columns allocate nothing.
  void make_room();

  /// Appends the first `count` columns of `rows` (all rows of L, zero off the path), which reach
  /// the supernodes of `path` (ascending).
  void append(std::span<const Index> path, const linear_algebra::RowMajor& rows, Index count);
  /// Takes the last append away.
  void pop();
  /// gram <- V^T rows over the supernodes of `path`, shape (size() x width); `width` columns of
  /// `rows` and `gram` are used, a multiple of 8.
  void multiply(std::span<const Index> path, const linear_algebra::RowMajor& rows, Index width,
                Eigen::Ref<linear_algebra::RowMajor> gram);
  /// Entries first ... size() - 1 of p <- V^T y.
  void project(const Eigen::VectorXd& y, Index first, Eigen::VectorXd& p);
  /// y += V c.
  void add(const Eigen::VectorXd& c, Eigen::VectorXd& y);

  [[nodiscard]] Index size() const { return columns_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  /// A supernode's block: `count` columns of the supernode's width, and which columns they are.
  struct Block {
    double* values = nullptr;
    Index* ids = nullptr;
    Index count = 0, capacity = 0;
  };
  struct Push {
    std::size_t path_begin;
    Index count;
  };

  void reserve(Index s, Index count);

  /// Room handed out piece by piece and freed as a whole.
  template <class T>
  class Arena {
   public:
    T* take(std::size_t count);

   private:
    static constexpr std::size_t kChunk = std::size_t{4} << 20;  // entries
    std::vector<std::unique_ptr<T[]>> chunks_;
    std::size_t used_ = kChunk;
  };

  const linear_algebra::Supernodes& nodes_;
  Arena<double> values_;
  Arena<Index> ids_;
  std::vector<Block> blocks_;
  // Supernodes whose block has held columns, ascending: sums over them do not tell what was popped.
  std::vector<Index> reached_;
  std::vector<Push> pushes_;
  std::vector<Index> paths_;  // of all pushes, one after the other
  std::vector<double> product_, gathered_;
  Index columns_ = 0;
};

}  // namespace sunder::solver
