// SPDX-License-Identifier: Apache-2.0
// The inverse of the intact board's stiffness, as the paper needs it, by Sunder and by what a user
// would take instead, one thread. `error` is the largest entry of A X - I over sampled columns.
#include <benchmark/benchmark.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <map>

#include "fem/factor.hpp"
#include "run_rows.hpp"
#include "tearing_board.hpp"

extern "C" {
void openblas_set_num_threads(int);
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dpotri_(const char* uplo, const int* n, double* a, const int* lda, int* info);
}

namespace sunder::bench {
namespace {

using Dense = Eigen::MatrixXd;

const fem::SparseMatrix& stiffness(Index cells) {
  static std::map<Index, fem::SparseMatrix> all;
  auto& k = all[cells];
  if (k.size() == 0) k = fem::assemble_lower(*TearingBoard(cells).problem, {});
  return k;
}

Dense by_sunder(const fem::SparseMatrix& lower) { return fem::Factor(lower).inverse(); }

Dense by_openblas(const fem::SparseMatrix& lower) {
  Dense a(lower);
  const int n = static_cast<int>(a.rows());
  int info = 0;
  dpotrf_("L", &n, a.data(), &n, &info);
  if (info == 0) dpotri_("L", &n, a.data(), &n, &info);
  if (info != 0) return {};
  a.triangularView<Eigen::StrictlyUpper>() = a.transpose();
  return a;
}

Dense by_eigen_llt(const fem::SparseMatrix& lower) {
  const Dense a(lower);
  return Eigen::LLT<Dense>(a).solve(Dense::Identity(a.rows(), a.rows()));
}

Dense by_eigen_lu(const fem::SparseMatrix& lower) {
  const Dense a = Dense(lower).selfadjointView<Eigen::Lower>();
  return Eigen::PartialPivLU<Dense>(a).inverse();
}

Dense by_eigen_sparse(const fem::SparseMatrix& lower) {
  const Eigen::SimplicialLDLT<fem::SparseMatrix> factor(lower);
  return factor.solve(Dense::Identity(lower.rows(), lower.rows()));
}

double error_of(const fem::SparseMatrix& lower, const Dense& inverse) {
  double worst = 0;
  for (Eigen::Index j = 0; j < lower.rows(); j += std::max<Eigen::Index>(1, lower.rows() / 20)) {
    Eigen::VectorXd r = lower.selfadjointView<Eigen::Lower>() * inverse.col(j);
    r[j] -= 1;
    worst = std::max(worst, r.lpNorm<Eigen::Infinity>());
  }
  return worst;
}

void invert(benchmark::State& state, Index cells, Dense (*run)(const fem::SparseMatrix&)) {
  const fem::SparseMatrix& k = stiffness(cells);
  Dense inverse;
  for (auto _ : state) {
    inverse = run(k);
    benchmark::DoNotOptimize(inverse.data());
  }
  if (inverse.rows() != k.rows()) return state.SkipWithError("not definite");
  state.counters["error"] = error_of(k, inverse);
  state.counters["unknowns"] = static_cast<double>(k.rows());
}

void register_rows() {
  const std::pair<const char*, Dense (*)(const fem::SparseMatrix&)> methods[] = {
      {"sunder", by_sunder},
      {"openblas_potrf_potri", by_openblas},
      {"eigen_llt", by_eigen_llt},
      {"eigen_partial_piv_lu", by_eigen_lu},
      {"eigen_simplicial_ldlt", by_eigen_sparse}};
  for (Index cells : {9, 18, 36}) {
    for (const auto& [name, run] : methods) {
      const std::string row =
          std::string("inversion/") + name + "/" + std::to_string(6 * cells * cells);
      benchmark::RegisterBenchmark(row.c_str(), [=, f = run](auto& s) { invert(s, cells, f); })
          ->MinTime(0.1)
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  openblas_set_num_threads(1);
  sunder::bench::register_rows();
  return sunder::bench::run_rows(argc, argv);
}
