// SPDX-License-Identifier: Apache-2.0
// The paper's Tables 2 and 3 on its board of 1954 tetrahedra: what each column costs here, and what
// the paper's way costs here, which rebuilds everything after every fracture. The row's time is one
// reconstruction as Sunder does it: update of the damage and displacement anew.
#include <benchmark/benchmark.h>

#include <chrono>

#include "app/reproduce/paper_times.hpp"
#include "body/assembly.hpp"
#include "body/element.hpp"
#include "linear_algebra/factor.hpp"
#include "run_rows.hpp"
#include "sunder/error.hpp"

namespace sunder::bench {
namespace {

namespace reproduce = app::reproduce;
using Clock = std::chrono::steady_clock;

/// Least time of some repetitions [ms].
template <class Run>
double least(int repetitions, const Run& run) {
  double best = 1e300;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = Clock::now();
    run();
    const std::chrono::duration<double, std::milli> time = Clock::now() - start;
    best = std::min(best, time.count());
  }
  return best;
}

using StressDisplacement = Eigen::Matrix<double, 6, 12>;

void stress_displacement(const Problem& problem, std::vector<StressDisplacement>& all) {
  for (Index e = 0; e < problem.tet_count(); ++e) {
    all[static_cast<std::size_t>(e)] =
        elasticity(problem.small_strain(e)) * fem::strain_displacement(problem.shape(e));
  }
}

/// Every row of Table 2 made anew.
void note_the_papers_way(benchmark::State& state, const Problem& problem) {
  linear_algebra::SparseMatrix k;
  std::vector<StressDisplacement> db(problem.mesh().tets.size());
  Eigen::MatrixXd inverse;
  state.counters["anew_stiffness_ms"] = least(5, [&] { k = fem::assemble_lower(problem, {}); });
  state.counters["anew_stress_displacement_ms"] =
      least(5, [&] { stress_displacement(problem, db); });
  state.counters["anew_inverse_ms"] =
      least(2, [&] { inverse = linear_algebra::Factor(k).inverse(); });
  const Eigen::VectorXd f = Eigen::VectorXd::Ones(inverse.rows());
  Eigen::VectorXd u;
  state.counters["anew_displacement_ms"] = least(5, [&] { u.noalias() = inverse * f; });
  benchmark::DoNotOptimize(u.data());
  benchmark::DoNotOptimize(db.data());
}

void column(benchmark::State& state, const reproduce::PaperColumn& paper) {
  const reproduce::Laboratory lab(
      "cpu", [] { return false; }, [](const std::string&) {});
  for (auto _ : state) {
    const reproduce::PaperTimes times = reproduce::measure_paper_times(lab, paper.plan);
    if (!times.solve || !times.stress || !times.decide || !times.update) {
      return state.SkipWithError("nothing broke: there is no time of a fracture");
    }
    state.SetIterationTime(1e-3 * (*times.update + *times.solve));
    state.counters["prepare_ms"] = times.prepare;
    state.counters["update_ms"] = *times.update;
    state.counters["solve_ms"] = *times.solve;
    state.counters["stress_ms"] = *times.stress;
    state.counters["decide_ms"] = *times.decide;
  }
  note_the_papers_way(state, Problem(lab.scene(paper.plan)));
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  for (const auto& paper : sunder::app::reproduce::paper_columns()) {
    benchmark::RegisterBenchmark(("paper/" + paper.name).c_str(),
                                 [=](benchmark::State& state) {
                                   try {
                                     sunder::bench::column(state, paper);
                                   } catch (const sunder::Error& error) {
                                     state.SkipWithError(error.what());
                                   }
                                 })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
  return sunder::bench::run_rows(argc, argv);
}
