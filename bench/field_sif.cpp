// SPDX-License-Identifier: Apache-2.0
// Time to decide which element ruptures on the notched board of 1954 elements, model B, K by the
// formula or from the field (the paper's Table 3: 2.86 s on a 3.2 GHz Xeon, of which 2.81 s stress
// intensity, .01 comparison, .01 update). One thread.
//   decide   the criterion alone under a load that breaks nothing: K and direction of the tip,
//            band, walk, comparison with the largest stress
//   rupture  the same under a load at which the crack grows: also the elements, their records, and
//            both criteria's K for the row
//   whole    with the stress of all elements and its summary, as a frame does
//   remote   what the formula needs besides, once per step: the field of the intact body
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "cpu_reference/cpu_reference.hpp"
#include "fracture/criterion.hpp"
#include "sunder/simulation.hpp"
#include "support/notch_board.hpp"

namespace sunder {
namespace {

Scene notched_board(SifSource sif, double force) {
  Scene scene = test::notch_board(FractureModel::b);
  scene.instruments[0].action = Pull{test::lower_right_corner(), Vec3(0, force, 0)};
  scene.instruments[0].ramp.reset();
  scene.steps = 1;
  scene.fracture.sif = sif;
  return scene;
}

/// The board solved under a force at its corner, the notch taken out.
class Bench {
 public:
  Bench(SifSource sif, double force)
      : problem_(std::make_shared<const Problem>(notched_board(sif, force))),
        backend_(cpu_reference::create(problem_, needs_of(*problem_))),
        force_(force) {
    renew_criterion();
    std::vector<Index> preset;
    for (const DestroyedElement& row : preset_) preset.push_back(row.element);
    backend_->destroy(preset);
    const auto& nodes = problem_->instrument_nodes()[0].nodes;
    for (Index n : nodes) {
      forces_.push_back({n, Vec3(0, force / static_cast<double>(nodes.size()), 0)});
      load_.force_dofs.push_back(problem_->dof(n, 1));
      load_.forces.push_back(forces_.back().force.y());
    }
    backend_->set_load(load_);
    backend_->solve();
    pristine_.resize(3 * problem_->mesh().nodes.size());
    solve_pristine();
    summary_ = backend_->stress();
  }

  void renew_criterion() {
    criterion_ = make_criterion(*problem_);
    preset_ = criterion_->preset().elements;
  }
  void solve_pristine() { backend_->solve_pristine(load_, pristine_); }
  void stress() { summary_ = backend_->stress(); }
  const Decision& decide() {
    criterion_->decide({*problem_,
                        backend_->destroyed(),
                        summary_,
                        [this](Index e) { return backend_->read_stress(e); },
                        [this] { return std::span<const double>(pristine_); },
                        Vec3(0, force_, 0),
                        {},
                        [this](std::span<const Index> ids, std::span<Vec3> u) {
                          backend_->read_displacement(ids, u);
                        },
                        [this] { return std::span<const NodalForce>(forces_); }},
                       decision_);
    return decision_;
  }

 private:
  std::shared_ptr<const Problem> problem_;
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<FractureCriterion> criterion_;
  std::vector<DestroyedElement> preset_;
  double force_;
  Load load_;
  std::vector<NodalForce> forces_;
  std::vector<double> pristine_;
  StressSummary summary_;
  Decision decision_;
};

constexpr double kHolds = -5, kBreaks = -60;  // [N]

void expect(benchmark::State& state, const Decision& decision, bool breaks) {
  if (decision.elements.empty() == breaks)
    state.SkipWithError(breaks ? "nothing breaks under this load" : "the board breaks");
  benchmark::DoNotOptimize(decision.elements.data());
}

void decide(benchmark::State& state, SifSource sif) {
  Bench bench(sif, kHolds);
  for (auto _ : state) expect(state, bench.decide(), false);
}

void rupture(benchmark::State& state, SifSource sif) {
  Bench bench(sif, kBreaks);
  for (auto _ : state) {
    state.PauseTiming();
    bench.renew_criterion();  // a decision moves its tips
    state.ResumeTiming();
    expect(state, bench.decide(), true);
  }
}

void whole(benchmark::State& state, SifSource sif) {
  Bench bench(sif, kHolds);
  for (auto _ : state) {
    bench.stress();
    expect(state, bench.decide(), false);
  }
}

void remote(benchmark::State& state) {
  Bench bench(SifSource::formula, kHolds);
  for (auto _ : state) bench.solve_pristine();
}

BENCHMARK_CAPTURE(decide, formula, SifSource::formula)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(decide, field, SifSource::field)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(rupture, formula, SifSource::formula)
    ->Unit(benchmark::kMicrosecond)
    ->Iterations(50);
BENCHMARK_CAPTURE(rupture, field, SifSource::field)->Unit(benchmark::kMicrosecond)->Iterations(50);
BENCHMARK_CAPTURE(whole, formula, SifSource::formula)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(whole, field, SifSource::field)->Unit(benchmark::kMicrosecond);
BENCHMARK(remote)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace sunder
