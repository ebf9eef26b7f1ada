// SPDX-License-Identifier: Apache-2.0
#include "frame_bases.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "body/assembly.hpp"
#include "body/stiffness_factor.hpp"
#include "solver/condensed_update.hpp"
#include "solver/region.hpp"
#include "torn_patch.hpp"

namespace sunder::bench {
namespace {

// Elements that are gone: as many columns as between two bases (solver/condensed_route.cpp).
constexpr std::size_t kBefore = 200, kSince = 300;

double ms_of(auto&& run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// An update of X_SS on top of one that kBefore elements made.
void bases(benchmark::State& state, Index cells, Index patch, int threads) {
  const auto shared = std::make_shared<Problem>(patch_scene(cells, patch));
  const Problem& problem = *shared;
  const std::vector<Index> order = patch_tear(problem);
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  const solver::Region region = solver::region_of(problem, needs);
  const linear_algebra::FactorWork work{.threads = threads};
  std::shared_ptr<const linear_algebra::Factor> factor;
  std::unique_ptr<solver::CondensedBase> base;
  for (auto _ : state) {
    const auto factored = [&] {
      factor = std::make_shared<linear_algebra::Factor>(fem::factor_stiffness(problem, {}, work));
    };
    state.counters["factor_ms"] = ms_of(factored);
    state.counters["inverse_ms"] =
        ms_of([&] { base = std::make_unique<solver::CondensedBase>(factor, region.dofs, work); });
    solver::CondensedState last;
    solver::DamageMatrices damage;
    Eigen::MatrixXd x;
    const auto tear = [&](std::size_t first, std::size_t count) {
      const solver::CondensedBase& below = *base;
      solver::Deferred deferred(problem, std::move(base));
      for (const Index& e : std::span(order).subspan(first, count)) {
        if (!deferred.destroy({&e, 1})) return state.SkipWithError("an event cannot be followed");
      }
      below.copy_state(last);
      deferred.copy_damage(damage);
      state.counters["columns"] = static_cast<double>(deferred.rank());
    };
    tear(0, kBefore);
    const double first_ms = ms_of([&] { x = solver::updated_inverse(last, damage, {}, work); });
    state.counters["first_update_ms"] = first_ms;
    base = std::make_unique<solver::CondensedBase>(
        last, std::move(x),
        std::make_shared<const solver::LostStiffness>(problem, std::span(order).first(kBefore)));
    tear(kBefore, kSince);
    const double ms = ms_of([&] { x = solver::updated_inverse(last, damage, {}, work); });
    state.counters["update_ms"] = ms;
    state.SetIterationTime(1e-3 * ms);
  }
  state.counters["unknowns"] = static_cast<double>(region.dofs.size());
}

/// The stiffness, beside Eigen's sum of the same elements' entries from a list.
void assembly(benchmark::State& state, Index cells) {
  const Problem problem(patch_scene(cells));
  linear_algebra::SparseMatrix stiffness, listed(problem.dof_count(), problem.dof_count());
  const auto list = [&] {
    std::vector<Eigen::Triplet<double, Index>> entries;
    entries.reserve(static_cast<std::size_t>(problem.tet_count()) * 78);
    for (Index e = 0; e < problem.tet_count(); ++e) {
      const fem::ElementMatrix k = fem::element_stiffness(problem, e);
      for (int i = 0; i < 144; ++i) {
        const auto& corners = problem.mesh().tets[static_cast<std::size_t>(e)];
        const Index row = problem.dof(corners[i % 12 / 3], i % 3),
                    column = problem.dof(corners[i / 36], i / 12 % 3);
        if (column != kNone && row >= column) entries.emplace_back(row, column, k(i % 12, i / 12));
      }
    }
    listed.setFromTriplets(entries.begin(), entries.end());
  };
  double least = HUGE_VAL, least_of_list = HUGE_VAL;
  for (auto _ : state) {
    const double ms = ms_of([&] { stiffness = fem::assemble_lower(problem, {}); });
    state.SetIterationTime(1e-3 * ms);
    least = std::min(least, ms);
    least_of_list = std::min(least_of_list, ms_of(list));
  }
  const bool same =
      listed.nonZeros() == stiffness.nonZeros() &&
      std::equal(listed.valuePtr(), listed.valuePtr() + listed.nonZeros(), stiffness.valuePtr());
  if (!same) state.SkipWithError("not what Eigen adds up");
  state.counters["min_ms"] = least;
  state.counters["eigen_ms"] = least_of_list;
  state.counters["eigen_over_ours"] = least_of_list / least;
}

}  // namespace

void register_bases() {
  for (const Index cells : {18, 141, 409}) {
    benchmark::RegisterBenchmark(("assembly/" + std::to_string(6 * cells * cells)).c_str(),
                                 [=](auto& s) { assembly(s, cells); })
        ->UseManualTime()
        ->Iterations(3)
        ->Unit(benchmark::kMillisecond);
  }
  for (const Index cells : {18, 141}) {
    for (const Index patch : {12, 40}) {
      if (patch > cells) continue;
      for (const int threads : {1, 2}) {
        const std::string row = "bases/" + std::to_string(6 * cells * cells) + "/" +
                                (patch == 12 ? "1k/" : "10k/") + std::to_string(threads);
        benchmark::RegisterBenchmark(row.c_str(), [=](auto& s) { bases(s, cells, patch, threads); })
            ->UseManualTime()
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
      }
    }
  }
}

}  // namespace sunder::bench
