// SPDX-License-Identifier: Apache-2.0
// Sparse Cholesky factor P A P^T = L L^T, held as dense panels of columns with equal structure.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "linear_algebra/factorise.hpp"
#include "linear_algebra/row_product.hpp"
#include "linear_algebra/supernodes.hpp"

namespace sunder::linear_algebra {

/// Room for triangular solves; kept by the caller, it stops allocating after the first ones.
struct SolveWork {
  std::vector<double> below, product;
  std::vector<std::uint8_t> seen;
  Eigen::VectorXd permuted;
};

class SupernodalCholesky {
 public:
  /// From the lower triangle; succeeded() tells whether A is positive definite in double precision.
  /// place[i] is a row of L for unknown i, to be refined; empty: by minimum degree.
  explicit SupernodalCholesky(const SparseMatrix& lower, std::vector<Index> place = {},
                              const FactorWork& work = {});
  /// From a lower triangle in the order of `nodes`.
  SupernodalCholesky(std::shared_ptr<const Supernodes> nodes, const SparseMatrix& ordered,
                     const FactorWork& work = {});
  [[nodiscard]] bool succeeded() const { return succeeded_; }

  [[nodiscard]] Index size() const { return static_cast<Index>(nodes_->place.size()); }
  [[nodiscard]] const Supernodes& supernodes() const { return *nodes_; }
  [[nodiscard]] const std::shared_ptr<const Supernodes>& shared_supernodes() const {
    return nodes_;
  }
  /// Entries of the panels: a triangular solve reads each once.
  [[nodiscard]] std::size_t entries() const { return nodes_->value_begin.back(); }
  [[nodiscard]] std::size_t bytes() const;

  /// Room for `columns` right sides, so that what follows allocates nothing.
  void make_room(Index columns, SolveWork& work) const;
  /// The supernodes that L^-1 b can reach from some rows of L, ascending: their paths to the root.
  void reach(std::span<const Index> rows, std::vector<Index>& path, SolveWork& work) const;

  /// y <- L^-1 y over the listed supernodes (ascending and closed under parents), y in the order of
  /// L and zero elsewhere.
  void forward(std::span<const Index> supernodes, Eigen::VectorXd& y, SolveWork& work) const;
  void forward(Eigen::VectorXd& y, SolveWork& work) const;
  /// y <- L^-T y.
  void backward(Eigen::VectorXd& y, SolveWork& work) const;
  /// The same for several right sides at once, shape (size() x right sides).
  void forward(std::span<const Index> supernodes, Eigen::Ref<RowMajor> y, SolveWork& work) const;
  /// The same bits for up to kFewColumns right sides, in less time.
  void forward_few(std::span<const Index> supernodes, Eigen::Ref<RowMajor> y,
                   SolveWork& work) const;
  void backward(Eigen::Ref<RowMajor> y, SolveWork& work) const;
  /// The rows of L^-T y at the listed supernodes (ascending and closed under parents) alone.
  void backward(std::span<const Index> supernodes, Eigen::Ref<RowMajor> y, SolveWork& work) const;

 private:
  using ConstPanel = Eigen::Map<const Eigen::MatrixXd>;
  using ConstRows = Eigen::Map<const RowMajor>;
  [[nodiscard]] ConstPanel panel(Index s) const;
  [[nodiscard]] std::size_t room_of_a_panel() const;
  void forward_panel(Index s, Eigen::VectorXd& y, SolveWork& work) const;

  void compute(const SparseMatrix& ordered, const FactorWork& work);

  std::shared_ptr<const Supernodes> nodes_;
  Eigen::VectorXd values_;
  Index tallest_ = 0;
  bool succeeded_ = false;
};

}  // namespace sunder::linear_algebra
