// SPDX-License-Identifier: Apache-2.0
// What a scene saves that needs less. One board of 2k, 30k and 120k tetrahedra, pulled at a corner:
// everything can tear (with each fracture prepared and without); only a patch of about 1,000
// unknowns can, over the factor and condensed (in cascades a patch of 3,750, too); nothing can;
// nobody asks for stress. The time of a row is that of a frame with one fracture (a quiet one where
// nothing can break), the least of all; predicted_* is what `sunder plan` says. Rows "simulated"
// tear by themselves, one event a step: hit_rate of the predictions, what they cost and what they
// spared in all. Rows "live_10k" tear 300 elements of a patch of 10,000 unknowns one by one, up to
// a body of a million: medians of the first and of the last 50, and what of these is the calling
// thread's, which a device leaves to the host. Rows "wander" cut 60 elements beyond a patch of
// 1,000 or 10,000 unknowns, where the region must grow, without a pause and with 33 ms after each
// ("rests"), in which a thread computes what it may grow by; the first of those is announced.
// "long_tear_device_inverse": 800 elements one by one under route inverse, whose inverse the device
// computes, over several bases. "wide_cut": 2,000 elements beyond the patch in one event, which
// makes a new base, and quiet_ms, the frame after it.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <thread>

#include "gpu/vulkan_backend.hpp"
#include "has_vulkan.hpp"
#include "quantile.hpp"
#include "run_rows.hpp"
#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"
#include "torn_patch.hpp"

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Variant {
  const char* name;
  Route route;
  bool all_breakable;
  bool stress, damage;
  bool prepare = false;  ///< each fracture, before its frame
  const char* backend = "cpu";
  Index patch = kPatch;  ///< cells along its edge
};

Scene scene_of(const Variant& variant, Index cells) {
  Scene scene = patch_scene(cells, variant.patch);
  if (variant.all_breakable) scene.materials["organ"].yield = 2.0;
  scene.solver.backend = variant.backend;
  scene.solver.route = variant.route;
  return scene;
}

struct FrameTime {
  double ms = 0, waited_ms = 0;
};

FrameTime frame(Backend& backend, const Load& load, std::span<const Index> broken) {
  const auto start = Clock::now();
  if (!broken.empty()) backend.destroy(broken);
  backend.set_load(load);
  const double waited = backend.solve().waited_ms;
  if (backend.needs().stress) backend.stress();
  return {milliseconds_since(start), waited};
}

/// What the forceps begin with.
Load corner_pull(const Problem& problem) {
  Load load;
  for (Index n : problem.instrument_nodes()[0].nodes) {
    load.force_dofs.push_back(problem.dof(n, 1));
    load.forces.push_back(-30);
  }
  return load;
}

void row(benchmark::State& state, const Variant& variant, Index cells) {
  const auto problem = std::make_shared<Problem>(scene_of(variant, cells));
  Needs needs;
  needs.stress = needs.yield = variant.stress;
  needs.damage = variant.damage;
  const auto start = Clock::now();
  const auto backend = create_backend(problem, needs).backend;
  state.counters["setup_ms"] = milliseconds_since(start);
  Load load = corner_pull(*problem);
  frame(*backend, load, {});  // has the full check
  const auto order = patch_tear(*problem);
  double quiet = 1e300, fracture = 1e300;
  std::size_t next = 0;
  for (auto _ : state) {
    const auto broken = std::span(order).subspan(next, variant.damage ? 1 : 0);
    next += broken.size();
    if (variant.prepare) backend->prepare(broken);
    const double ms = frame(*backend, load, broken).ms;
    for (double& f : load.forces) f *= 1.0009765625;
    quiet = std::min(quiet, frame(*backend, load, {}).ms);
    fracture = std::min(fracture, ms);
    state.SetIterationTime(1e-3 * (variant.damage ? ms : quiet));
  }
  const BackendInfo info = backend->info();
  state.counters["min_ms"] = variant.damage ? fracture : quiet;
  state.counters["quiet_ms"] = quiet;
  state.counters["predicted_quiet_ms"] = info.quiet_ms;
  state.counters["predicted_fracture_ms"] = info.fracture_ms;
  const PreparationReport preparation = backend->preparation();
  if (preparation.destroyed > 0) {
    state.counters["prepare_ms"] = preparation.spent_ms / preparation.destroyed;
    state.counters["spared_ms"] = preparation.saved_ms / preparation.destroyed;
  }
  state.counters["MiB"] = static_cast<double>(info.memory_bytes) / 1048576;
  state.counters["unknowns"] = static_cast<double>(problem->dof_count());
  double condensed = 0;
  for (const BufferPlan& b : backend->buffers()) {
    if (b.name.starts_with("condensed inverse")) condensed += static_cast<double>(b.bytes);
  }
  state.counters["inverse_MiB"] = condensed / 1048576;
}

double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// `by_device`: where the device multiplies the columns of the region.
void live(benchmark::State& state, const Variant& variant, bool by_device, Index cells) {
  const auto problem = std::make_shared<Problem>(scene_of(variant, cells));
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  const auto start = Clock::now();
  std::unique_ptr<Backend> backend;
  if (by_device) {
    gpu::VulkanOptions options;
    options.region_on_device = true;
    backend = gpu::create(problem, needs, options);
  } else {
    backend = create_backend(problem, needs).backend;
  }
  state.counters["setup_ms"] = milliseconds_since(start);
  Load load = corner_pull(*problem);
  frame(*backend, load, {});  // has the full check
  state.counters["predicted_first_ms"] = backend->info().fracture_ms;
  const auto order = patch_tear(*problem);
  std::vector<double> times, host;
  for (auto _ : state) {
    const double before = thread_ms();
    const double ms = frame(*backend, load, {&order[times.size()], 1}).ms;
    host.push_back(thread_ms() - before);
    times.push_back(ms);
    state.SetIterationTime(1e-3 * ms);
    for (double& f : load.forces) f *= 1.0009765625;
  }
  const std::size_t some = std::min<std::size_t>(50, times.size());
  state.counters["first_ms"] = median_of({times.begin(), times.begin() + some});
  state.counters["last_ms"] = median_of({times.end() - some, times.end()});
  state.counters["last_host_ms"] = median_of({host.end() - some, host.end()});
  state.counters["predicted_last_ms"] = backend->info().fracture_ms;
  state.counters["MiB"] = static_cast<double>(backend->info().memory_bytes) / 1048576;
  state.counters["unknowns"] = static_cast<double>(problem->dof_count());
}

/// A host that cuts where nothing breaks by itself, on from the patch: an element a frame, `rest`
/// after each. With rests the first one is announced a rest before.
void wander(benchmark::State& state, const Variant& variant, std::chrono::milliseconds rest,
            Index cells) {
  const auto problem = std::make_shared<Problem>(scene_of(variant, cells));
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  const auto backend = create_backend(problem, needs).backend;
  Load load = corner_pull(*problem);
  frame(*backend, load, {});
  const auto order = tear_beyond_patch(*problem);
  if (rest.count() > 0) backend->prepare({order.data(), 1});
  std::this_thread::sleep_for(rest);
  std::vector<double> times;
  for (auto _ : state) {
    const double ms = frame(*backend, load, {&order[times.size()], 1}).ms;
    times.push_back(ms);
    state.SetIterationTime(1e-3 * ms);
    std::this_thread::sleep_for(rest);
  }
  state.counters["first_ms"] = times.front();
  std::sort(times.begin(), times.end());
  state.counters["median_ms"] = state.counters["min_ms"] = median_of(times);
  state.counters["p90_ms"] = times[times.size() * 9 / 10];
  state.counters["worst_ms"] = times.back();
}

void register_wander() {
  constexpr Index kCells = 141;
  for (const Index patch : {kPatch, Index{40}}) {
    for (const int rest : {0, 33}) {
      const Variant variant{"wander", Route::condensed, false, true, true, false, "cpu", patch};
      benchmark::RegisterBenchmark(
          ("needs/wander" + std::string(patch == kPatch ? "_1k" : "_10k") +
           (rest > 0 ? "_rests/" : "/") + std::to_string(6 * kCells * kCells))
              .c_str(),
          [=](auto& state) { wander(state, variant, std::chrono::milliseconds(rest), kCells); })
          ->UseManualTime()
          ->Iterations(60)
          ->Unit(benchmark::kMillisecond);
    }
  }
}

/// One event of 2,000 elements beyond the patch, and the frame after it.
void wide_cut(benchmark::State& state, const Variant& variant, Index cells) {
  const auto problem = std::make_shared<Problem>(scene_of(variant, cells));
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  const auto backend = create_backend(problem, needs).backend;
  const Load load = corner_pull(*problem);
  frame(*backend, load, {});
  const auto order = tear_beyond_patch(*problem);
  for (auto _ : state) {
    const double ms = frame(*backend, load, {order.data(), 2000}).ms;
    state.counters["min_ms"] = state.counters["median_ms"] = ms;
    state.SetIterationTime(1e-3 * ms);
  }
  state.counters["quiet_ms"] = frame(*backend, load, {}).ms;
  state.counters["new_bases"] = backend->take_new_bases().count;
}

void register_wide_cut() {
  constexpr Index kCells = 141;
  for (const Variant& v : {Variant{"condensed", Route::condensed, false, true, true},
                           Variant{"factor", Route::factor, false, true, true}}) {
    benchmark::RegisterBenchmark(
        ("needs/wide_cut_" + std::string(v.name) + "/" + std::to_string(6 * kCells * kCells))
            .c_str(),
        [=](auto& state) { wide_cut(state, v, kCells); })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
}

void register_live() {
  struct Row {
    const char *name, *backend;
    bool by_device;
  };
  std::vector<Row> rows{{"cpu", "cpu", false}};
  if (has_vulkan()) {
    rows.push_back({"vulkan", "vulkan", false});
    rows.push_back({"vulkan_multiplies", "vulkan", true});
  }
  for (const Index cells : {141, 409}) {
    for (const Row& of : rows) {
      const Variant variant{of.name, Route::condensed, false, true, true, false, of.backend, 40};
      benchmark::RegisterBenchmark(
          ("needs/live_10k_" + std::string(of.name) + "/" + std::to_string(6 * cells * cells))
              .c_str(),
          [=](auto& state) { live(state, variant, of.by_device, cells); })
          ->UseManualTime()
          ->Iterations(300)
          ->Unit(benchmark::kMillisecond);
    }
  }
}

/// 640 fractures of the patch, one a frame.
void cascade(benchmark::State& state, const Variant& variant, Index cells) {
  const auto problem = std::make_shared<Problem>(scene_of(variant, cells));
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  const auto order = patch_tear(*problem);
  const std::size_t count = std::min<std::size_t>(640, order.size());
  Load load = corner_pull(*problem);
  for (auto _ : state) {
    const auto backend = create_backend(problem, needs).backend;
    frame(*backend, load, {});
    std::vector<double> ms;
    double waited = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const FrameTime time = frame(*backend, load, {&order[i], 1});
      ms.push_back(time.ms);
      waited += time.waited_ms;
    }
    state.SetIterationTime(1e-3 * median_of(ms));
    state.counters["first_ms"] = median_of({ms.begin(), ms.begin() + 5});
    for (std::size_t k : {50, 100, 200, 400, 640}) {  // the median of the 20 before
      if (k > ms.size()) break;
      const auto end = ms.begin() + static_cast<std::ptrdiff_t>(k);
      state.counters["at_" + std::to_string(k) + "_ms"] = median_of({end - 20, end});
    }
    state.counters["median_ms"] = state.counters["min_ms"] = median_of(ms);
    std::sort(ms.begin(), ms.end());
    state.counters["p99_ms"] = ms[ms.size() * 99 / 100];
    state.counters["worst_ms"] = ms.back();
    state.counters["waited_ms"] = waited;
  }
}

/// A tear that goes on for long where the device has computed the inverse: a new base's comes from
/// the last one's.
void long_tear(benchmark::State& state, Index cells) {
  const Variant variant{"", Route::inverse, false, true, true, false, "vulkan", 12};
  Scene scene = scene_of(variant, cells);
  scene.solver.precision = Precision::fp64;
  const auto problem = std::make_shared<Problem>(std::move(scene));
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  gpu::VulkanOptions options;
  options.invert_on_device = true;
  const auto backend = gpu::create(problem, needs, options);
  Load load = corner_pull(*problem);
  frame(*backend, load, {});
  const auto order = patch_tear(*problem);
  std::vector<double> times, host;
  for (auto _ : state) {
    const double before = thread_ms();
    times.push_back(frame(*backend, load, {&order[times.size()], 1}).ms);
    host.push_back(thread_ms() - before);
    state.SetIterationTime(1e-3 * times.back());
  }
  const std::size_t some = times.size() / 6;
  state.counters["last_ms"] = median_of({times.end() - some, times.end()});
  state.counters["last_host_ms"] = median_of({host.end() - some, host.end()});
  std::sort(host.begin(), host.end());
  state.counters["median_host_ms"] = median_of(host);
  state.counters["p99_host_ms"] = host[host.size() * 99 / 100];
  state.counters["bases"] = backend->take_new_bases().count;
  state.counters["median_ms"] = state.counters["min_ms"] = median_of(times);
}

constexpr int kSteps = 60;

/// The board with a notch at the middle of its right edge, under model B: it tears by itself.
Scene notched(const Variant& variant, Index cells) {
  Scene scene = scene_of(variant, cells);
  const double h = 50.0 / cells;
  PresetCrack notch;
  std::vector<Index> elements;
  const Index row = cells / 2, depth = std::max<Index>(1, cells / 12);
  for (Index i = cells - depth; i < cells; ++i) {
    for (Index k = 0; k < 6; ++k) elements.push_back(6 * (i + cells * row) + k);
  }
  const double y = (row + 0.5) * h;
  notch.elements = elements;
  notch.mouth = Vec3(50, y, 1.25);
  notch.tips = {Vec3(50 - depth * h, y, 1.25)};
  scene.cracks.push_back(notch);
  scene.fracture.model = FractureModel::b;
  scene.fracture.max_events = 1;  // a step
  scene.solver.prepare = variant.prepare;
  scene.instruments[0].ramp = Ramp{0, 1};
  scene.steps = kSteps;
  return scene;
}

/// A simulation that predicts its fractures by itself, not all of them right. The time of the row:
/// stage `update` of a step that tears.
void simulated(benchmark::State& state, const Variant& variant, Index cells) {
  const auto problem = std::make_shared<const Problem>(notched(variant, cells));
  for (auto _ : state) {
    Simulation simulation(problem, create_backend(problem, needs_of(*problem)).backend);
    std::vector<double> update;
    double total = 0;
    while (!simulation.done()) {
      const StepReport step = simulation.step();
      if (step.step == 0 || step.events == 0) continue;  // the first has the notch
      update.push_back(step.times.update);
      total += step.times.update;
    }
    if (update.empty()) {
      state.SkipWithError("nothing tears");
      return;
    }
    state.SetIterationTime(1e-3 * median_of(update));
    const PreparationReport preparation = simulation.backend().preparation();
    state.counters["min_ms"] = median_of(update);
    state.counters["update_ms"] = total;
    state.counters["fractures"] = static_cast<double>(simulation.destroyed().size());
    state.counters["prepare_ms"] = preparation.spent_ms;
    state.counters["spared_ms"] = preparation.saved_ms;
    state.counters["hit_rate"] =
        preparation.destroyed > 0
            ? static_cast<double>(preparation.predicted) / preparation.destroyed
            : 0.0;
  }
}

void register_simulated(Index cells) {
  for (const bool prepare : {false, true}) {
    const Variant v{prepare ? "prepared" : "unprepared", Route::factor, true, true, true, prepare};
    benchmark::RegisterBenchmark(
        ("needs/simulated_" + std::string(v.name) + "/" + std::to_string(6 * cells * cells))
            .c_str(),
        [=](auto& state) { simulated(state, v, cells); })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
}

void register_rows() {
  std::vector<Variant> variants{
      {"all_tears_factor", Route::factor, true, true, true},
      {"all_tears_factor_prepared", Route::factor, true, true, true, true},
      {"patch_tears_factor", Route::factor, false, true, true},
      {"patch_tears_condensed", Route::condensed, false, true, true},
      {"nothing_tears", Route::automatic, true, true, false},
      {"displacement_only", Route::automatic, true, false, false}};
  if (has_vulkan()) {
    variants.push_back(
        {"patch_tears_condensed_vulkan", Route::condensed, false, true, true, false, "vulkan"});
  }
  for (Index cells : {18, 71, 141}) {
    for (const Variant& v : variants) {
      benchmark::RegisterBenchmark(
          ("needs/" + std::string(v.name) + "/" + std::to_string(6 * cells * cells)).c_str(),
          [=](auto& state) { row(state, v, cells); })
          ->UseManualTime()
          ->Iterations(40)
          ->Unit(benchmark::kMillisecond);
    }
    register_simulated(cells);
    if (has_vulkan() && cells == 18) {
      benchmark::RegisterBenchmark(
          ("needs/long_tear_device_inverse/" + std::to_string(6 * cells * cells)).c_str(),
          [=](auto& state) { long_tear(state, cells); })
          ->UseManualTime()
          ->Iterations(800)
          ->Unit(benchmark::kMillisecond);
    }
    std::vector<Variant> cascades{{"factor", Route::factor, false, true, true},
                                  {"condensed", Route::condensed, false, true, true}};
    if (cells > 18) {
      cascades.push_back({"condensed_3750", Route::condensed, false, true, true, false, "cpu", 24});
    }
    if (cells > 71) {
      cascades.push_back({"condensed_10k", Route::condensed, false, true, true, false, "cpu", 40});
    }
    for (const Variant& v : cascades) {
      benchmark::RegisterBenchmark(
          ("needs/patch_cascade_" + std::string(v.name) + "/" + std::to_string(6 * cells * cells))
              .c_str(),
          [=](auto& state) { cascade(state, v, cells); })
          ->UseManualTime()
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  sunder::bench::register_rows();
  sunder::bench::register_live();
  sunder::bench::register_wander();
  sunder::bench::register_wide_cut();
  return sunder::bench::run_rows(argc, argv);
}
