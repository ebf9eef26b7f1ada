// SPDX-License-Identifier: Apache-2.0
// CHOLMOD and OpenBLAS without Sunder: matrices from Matrix Market files, nothing of this project
// linked. One line per peer: name, tab, least and median time of one event with its solution [ms].
//   bench_peers_alone FOLDER [REPETITIONS]     files of `bench_reconstruction --write FOLDER BODY
//   K`
#include <cholmod.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

extern "C" {
void openblas_set_num_threads(int);
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dpotri_(const char* uplo, const int* n, double* a, const int* lda, int* info);
}

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(const std::function<void()>& run) {
  const auto start = Clock::now();
  run();
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Files {
  Files(const std::string& folder, cholmod_common& common)
      : intact(read(folder + "/intact.mtx", common)),
        damaged(read(folder + "/damaged.mtx", common)),
        columns(read(folder + "/columns.mtx", common)) {
    load = cholmod_zeros(intact->nrow, 1, CHOLMOD_REAL, &common);
    static_cast<double*>(load->x)[intact->nrow - 1] = 1;
  }
  static cholmod_sparse* read(const std::string& path, cholmod_common& common) {
    FILE* file = std::fopen(path.c_str(), "r");
    if (!file) throw std::runtime_error("cannot read " + path);
    cholmod_sparse* matrix = cholmod_read_sparse(file, &common);
    std::fclose(file);
    if (!matrix) throw std::runtime_error(path + " is no Matrix Market file");
    return matrix;
  }
  cholmod_sparse *intact, *damaged, *columns;
  cholmod_dense* load;
};

/// One factor with the work space of its solutions.
struct Factor {
  Factor(const Files& files, int supernodal, cholmod_common& c) : common(c) {
    common.supernodal = supernodal;
    l = cholmod_analyze(files.intact, &common);
    cholmod_factorize(files.intact, l, &common);
  }
  ~Factor() {
    cholmod_free_factor(&l, &common);
    for (cholmod_dense** d : {&u, &y, &e}) cholmod_free_dense(d, &common);
  }
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;
  void solve(int system, cholmod_dense* rhs) {
    cholmod_solve2(system, l, rhs, nullptr, &u, nullptr, &y, &e, &common);
  }
  cholmod_common& common;
  cholmod_factor* l;
  cholmod_dense *u = nullptr, *y = nullptr, *e = nullptr;
};

double refactor(const Files& files, int supernodal, cholmod_common& common) {
  Factor factor(files, supernodal, common);
  factor.solve(CHOLMOD_A, files.load);
  return milliseconds([&] {
    cholmod_factorize(files.damaged, factor.l, &common);
    factor.solve(CHOLMOD_A, files.load);
  });
}

double updown(const Files& files, bool with_solve, cholmod_common& common) {
  Factor factor(files, CHOLMOD_AUTO, common);
  cholmod_change_factor(CHOLMOD_REAL, 0, 0, 0, 1, factor.l, &common);
  cholmod_sparse* c =
      cholmod_submatrix(files.columns, static_cast<int*>(factor.l->Perm),
                        static_cast<SuiteSparse_long>(factor.l->n), nullptr, -1, 1, 1, &common);
  cholmod_dense* permuted = cholmod_solve(CHOLMOD_P, factor.l, files.load, &common);
  cholmod_dense* forward = cholmod_solve(CHOLMOD_L, factor.l, permuted, &common);
  cholmod_dense* unchanged = cholmod_zeros(factor.l->n, 1, CHOLMOD_REAL, &common);
  cholmod_dense* u = nullptr;
  factor.solve(CHOLMOD_A, files.load);
  const double ms = milliseconds([&] {
    if (with_solve) {
      cholmod_updown_solve(0, c, factor.l, forward, unchanged, &common);
      factor.solve(CHOLMOD_DLt, forward);
      u = cholmod_solve(CHOLMOD_Pt, factor.l, factor.u, &common);
    } else {
      cholmod_updown(0, c, factor.l, &common);
      factor.solve(CHOLMOD_A, files.load);
    }
  });
  cholmod_free_sparse(&c, &common);
  for (cholmod_dense** d : {&permuted, &forward, &unchanged, &u}) cholmod_free_dense(d, &common);
  return ms;
}

double dense(const Files& files, cholmod_common& common) {
  cholmod_dense* a = cholmod_sparse_to_dense(files.damaged, &common);
  const int n = static_cast<int>(a->nrow);
  int info = 0;
  const double ms = milliseconds([&] {
    dpotrf_("L", &n, static_cast<double*>(a->x), &n, &info);
    dpotri_("L", &n, static_cast<double*>(a->x), &n, &info);
  });
  cholmod_free_dense(&a, &common);
  return ms;
}

void row(const char* name, int repetitions, const std::function<double()>& run) {
  std::vector<double> ms;
  for (int i = 0; i < repetitions; ++i) ms.push_back(run());
  std::sort(ms.begin(), ms.end());
  std::printf("%s\t%.6g\t%.6g\n", name, ms.front(), ms[ms.size() / 2]);
}

}  // namespace

int main(int argc, char** argv) try {
  const int repetitions = argc > 2 ? std::atoi(argv[2]) : 9;
  if (argc < 2 || argc > 3 || repetitions < 1) {
    std::fprintf(stderr, "usage: bench_peers_alone FOLDER [REPETITIONS]\n");
    return 2;
  }
  openblas_set_num_threads(1);
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  const Files files(argv[1], common);
  row("cholmod simplicial refactor", repetitions,
      [&] { return refactor(files, CHOLMOD_SIMPLICIAL, common); });
  row("cholmod supernodal refactor", repetitions,
      [&] { return refactor(files, CHOLMOD_SUPERNODAL, common); });
  row("cholmod updown", repetitions, [&] { return updown(files, false, common); });
  row("cholmod updown_solve", repetitions, [&] { return updown(files, true, common); });
  if (files.intact->nrow < 4000) {
    row("openblas potrf potri", repetitions, [&] { return dense(files, common); });
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_peers_alone: %s\n", error.what());
  return 3;
}
