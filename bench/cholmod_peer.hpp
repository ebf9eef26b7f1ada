// SPDX-License-Identifier: Apache-2.0
// What a user would pick instead: CHOLMOD's refactorisation and its low-rank modification (Davis
// and Hager 2009). In the benchmark only; nothing of the library links it.
#pragma once

#include <cholmod.h>

#include <stdexcept>

#include "cholmod_data.hpp"
#include "tearing_board.hpp"

namespace sunder::bench {

class Cholmod {
 public:
  explicit Cholmod(const TearingBoard& board) : board_(board) {
    cholmod_start(&common_);
    common_.print = 0;
    a_ = matrix({});
    l_ = cholmod_analyze(a_, &common_);
    cholmod_factorize(a_, l_, &common_);
    pristine_ = cholmod_copy_factor(l_, &common_);
    // Low-rank modification wants LDL^T by columns.
    cholmod_change_factor(CHOLMOD_REAL, 0, 0, 0, 1, pristine_, &common_);
    b_ = cholmod_zeros(a_->nrow, 1, CHOLMOD_REAL, &common_);
    for (std::size_t i = 0; i < board.load_dofs.size(); ++i) {
      static_cast<double*>(b_->x)[board.load_dofs[i]] = board.load_values[i];
    }
    unchanged_ = cholmod_zeros(a_->nrow, 1, CHOLMOD_REAL, &common_);
    permuted_ = cholmod_solve(CHOLMOD_P, pristine_, b_, &common_);
    forward_ = cholmod_solve(CHOLMOD_L, pristine_, permuted_, &common_);
    require(common_.status == CHOLMOD_OK);
  }
  ~Cholmod() {
    for (cholmod_dense** d : {&b_, &unchanged_, &permuted_, &forward_, &work_x_, &u_}) {
      cholmod_free_dense(d, &common_);
    }
    for (cholmod_factor** f : {&l_, &pristine_, &work_}) cholmod_free_factor(f, &common_);
    for (cholmod_sparse** s : {&a_, &damaged_, &c_}) cholmod_free_sparse(s, &common_);
    cholmod_finish(&common_);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  /// Untimed: update vectors in the factor's order, damaged matrix, a fresh copy of the factor.
  void prepare(std::span<const Index> elements) {
    cholmod_free_factor(&work_, &common_);
    cholmod_free_dense(&work_x_, &common_);
    cholmod_free_dense(&u_, &common_);
    work_ = cholmod_copy_factor(pristine_, &common_);
    work_x_ = cholmod_copy_dense(forward_, &common_);
    if (!c_) {
      c_ = vectors(elements);
      damaged_ = matrix(elements);
    }
  }
  void updown_then_solve() {
    cholmod_updown(0, c_, work_, &common_);
    u_ = cholmod_solve(CHOLMOD_A, work_, b_, &common_);
  }
  void updown_solve() {
    cholmod_updown_solve(0, c_, work_, work_x_, unchanged_, &common_);
    cholmod_dense* y = cholmod_solve(CHOLMOD_DLt, work_, work_x_, &common_);
    u_ = cholmod_solve(CHOLMOD_Pt, work_, y, &common_);
    cholmod_free_dense(&y, &common_);
  }
  void refactor() {
    cholmod_factorize(damaged_, l_, &common_);
    u_ = cholmod_solve(CHOLMOD_A, l_, b_, &common_);
  }
  [[nodiscard]] Eigen::VectorXd solution() const {
    require(u_ != nullptr);
    return Eigen::Map<const Eigen::VectorXd>(static_cast<double*>(u_->x),
                                             static_cast<Eigen::Index>(u_->nrow));
  }

 private:
  static void require(bool condition) {
    if (!condition) throw std::runtime_error("CHOLMOD failed");
  }

  cholmod_sparse* matrix(std::span<const Index> destroyed) {
    return to_cholmod(damaged_stiffness(*board_.problem, destroyed), -1, common_);
  }
  cholmod_sparse* vectors(std::span<const Index> elements) {
    return to_cholmod(update_columns(*board_.problem, elements, order_of(*pristine_)), 0, common_);
  }

  const TearingBoard& board_;
  mutable cholmod_common common_{};
  cholmod_sparse *a_ = nullptr, *damaged_ = nullptr, *c_ = nullptr;
  cholmod_factor *l_ = nullptr, *pristine_ = nullptr, *work_ = nullptr;
  cholmod_dense *b_ = nullptr, *unchanged_ = nullptr, *permuted_ = nullptr, *forward_ = nullptr,
                *work_x_ = nullptr, *u_ = nullptr;
};

}  // namespace sunder::bench
