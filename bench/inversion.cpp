// SPDX-License-Identifier: Apache-2.0
// The inverse of the intact board's stiffness, as the paper needs it, by Sunder and by what a user
// would take instead, one thread. `error` is the largest entry of A X - I over sampled columns.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <map>
#include <vector>

#include "bench/peers/matrix_peer.hpp"
#include "body/assembly.hpp"
#include "linear_algebra/factor.hpp"
#include "run_rows.hpp"
#include "tearing_board.hpp"

extern "C" void openblas_set_num_threads(int);

namespace sunder::bench {
namespace {

const linear_algebra::SparseMatrix& stiffness(Index cells) {
  static std::map<Index, linear_algebra::SparseMatrix> all;
  auto& k = all[cells];
  if (k.size() == 0) k = fem::assemble_lower(*TearingBoard(cells).problem, {});
  return k;
}

class Sunder : public MatrixPeer {
 public:
  void set_matrix(const LowerTriangle& m) override {
    k_ = Eigen::Map<const linear_algebra::SparseMatrix>(
        m.n, m.n, static_cast<Index>(m.values.size()), m.outer.data(), m.inner.data(),
        m.values.data());
  }
  void update() override { inverse_ = linear_algebra::Factor(k_).inverse(); }
  void solve(std::span<const double> f, std::span<double> u) override {
    Eigen::Map<Eigen::VectorXd>(u.data(), inverse_.rows()) =
        inverse_ * Eigen::Map<const Eigen::VectorXd>(f.data(), inverse_.rows());
  }
  std::size_t bytes() const override {
    return sizeof(double) * static_cast<std::size_t>(inverse_.size());
  }

 private:
  linear_algebra::SparseMatrix k_;
  Eigen::MatrixXd inverse_;
};

double error_of(const linear_algebra::SparseMatrix& lower, MatrixPeer& inverse) {
  const auto n = static_cast<std::size_t>(lower.rows());
  double worst = 0;
  for (std::size_t j = 0; j < n; j += std::max<std::size_t>(1, n / 20)) {
    std::vector<double> unit(n, 0.0), column(n);
    unit[j] = 1;
    inverse.solve(unit, column);
    Eigen::VectorXd r = lower.selfadjointView<Eigen::Lower>() *
                        Eigen::Map<const Eigen::VectorXd>(column.data(), lower.rows());
    r[static_cast<Eigen::Index>(j)] -= 1;
    worst = std::max(worst, r.lpNorm<Eigen::Infinity>());
  }
  return worst;
}

void invert(benchmark::State& state, Index cells, const MatrixPeerKind& kind) {
  const linear_algebra::SparseMatrix& k = stiffness(cells);
  const auto entries = static_cast<std::size_t>(k.nonZeros());
  const auto peer = kind.create();
  for (auto _ : state) {
    state.PauseTiming();
    peer->set_matrix({static_cast<int>(k.rows()),
                      {k.outerIndexPtr(), static_cast<std::size_t>(k.cols()) + 1},
                      {k.innerIndexPtr(), entries},
                      {k.valuePtr(), entries}});
    state.ResumeTiming();
    peer->update();
  }
  state.counters["error"] = error_of(k, *peer);
  state.counters["unknowns"] = static_cast<double>(k.rows());
}

void register_rows() {
  std::vector<MatrixPeerKind> kinds = dense_peers();
  kinds.insert(kinds.begin(), {"sunder", "", 8000, [] { return std::make_unique<Sunder>(); }});
  for (Index cells : {9, 18, 36}) {
    for (const MatrixPeerKind& kind : kinds) {
      const Index tets = 6 * cells * cells;
      if (tets > kind.most_tets) continue;
      benchmark::RegisterBenchmark(("inversion/" + kind.name + "/" + std::to_string(tets)).c_str(),
                                   [=](auto& s) { invert(s, cells, kind); })
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
