// SPDX-License-Identifier: Apache-2.0
#include "frame_bases.hpp"

#include <benchmark/benchmark.h>

#include <chrono>
#include <string>

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

}  // namespace

void register_bases() {
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
