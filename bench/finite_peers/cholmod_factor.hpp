// SPDX-License-Identifier: Apache-2.0
// CHOLMOD's Cholesky factor of a matrix whose pattern stays: analysed once, factored each time
// (Chen, Davis, Hager and Rajamanickam 2008). In the benchmark only.
#pragma once

#include <cholmod.h>

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <limits>
#include <stdexcept>

#include "linear_algebra/sparse_matrix.hpp"

extern "C" void openblas_set_num_threads(int);

namespace sunder::bench {

class CholmodFactor {
 public:
  CholmodFactor() {
    cholmod_start(&common_);
    common_.print = 0;
  }
  ~CholmodFactor() {
    for (cholmod_dense** d : {&b_, &x_, &y_, &e_}) cholmod_free_dense(d, &common_);
    cholmod_free_factor(&l_, &common_);
    cholmod_finish(&common_);
  }
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;

  /// Of a lower triangle; false: it is not positive definite.
  bool factor(const linear_algebra::SparseMatrix& lower) {
    cholmod_sparse a = view(lower);
    if (!l_) l_ = cholmod_analyze(&a, &common_);
    if (!l_) throw std::runtime_error("CHOLMOD failed");
    cholmod_factorize(&a, l_, &common_);
    if (common_.status < CHOLMOD_OK) throw std::runtime_error("CHOLMOD failed");
    return common_.status == CHOLMOD_OK && l_->minor >= l_->n;
  }
  /// OpenBLAS gets the number of threads, at most `most`, with which it factors quicker: on small
  /// supernodes, and where others use the machine too, several wait for one another.
  void choose_threads(const linear_algebra::SparseMatrix& lower, int most) {
    double least = std::numeric_limits<double>::infinity();
    int best = 1;
    for (int threads = 1; threads <= most; ++threads) {
      openblas_set_num_threads(threads);
      for (int i = 0; i < 3; ++i) {
        const auto start = std::chrono::steady_clock::now();
        factor(lower);
        const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
        if (l_->minor < l_->n || time.count() >= least || (i == 0 && threads == 1)) continue;
        least = time.count();
        best = threads;
      }
    }
    openblas_set_num_threads(best);
  }
  /// For all columns of b.
  void solve(const Eigen::MatrixXd& b, Eigen::MatrixXd& x) {
    const auto rows = static_cast<std::size_t>(b.rows()),
               columns = static_cast<std::size_t>(b.cols());
    if (!b_) b_ = cholmod_allocate_dense(rows, columns, rows, CHOLMOD_REAL, &common_);
    std::copy_n(b.data(), b.size(), static_cast<double*>(b_->x));
    cholmod_solve2(CHOLMOD_A, l_, b_, nullptr, &x_, nullptr, &y_, &e_, &common_);
    if (common_.status != CHOLMOD_OK) throw std::runtime_error("CHOLMOD failed");
    x.resize(b.rows(), b.cols());
    std::copy_n(static_cast<const double*>(x_->x), x.size(), x.data());
  }

 private:
  /// Of Eigen's own arrays.
  static cholmod_sparse view(const linear_algebra::SparseMatrix& m) {
    auto& of = const_cast<linear_algebra::SparseMatrix&>(m);  // CHOLMOD's type knows no const
    cholmod_sparse s{};
    s.nrow = static_cast<std::size_t>(of.rows());
    s.ncol = static_cast<std::size_t>(of.cols());
    s.nzmax = static_cast<std::size_t>(of.nonZeros());
    s.p = of.outerIndexPtr();
    s.i = of.innerIndexPtr();
    s.x = of.valuePtr();
    s.stype = -1;
    s.itype = CHOLMOD_INT;
    s.xtype = CHOLMOD_REAL;
    s.dtype = CHOLMOD_DOUBLE;
    s.sorted = s.packed = 1;
    return s;
  }

  cholmod_common common_{};
  cholmod_factor* l_ = nullptr;
  cholmod_dense *b_ = nullptr, *x_ = nullptr, *y_ = nullptr, *e_ = nullptr;
};

}  // namespace sunder::bench
