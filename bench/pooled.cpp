// SPDX-License-Identifier: Apache-2.0
// What pooled volume costs: the board of the engine's benchmarks on route factor, and on Vulkan by
// inverse and by conjugate gradients, each element with its own volume and pooled in patches of
// eight. Rows: a frame of a new load, one with a fracture (solution with its check, stress with its
// summary), the factor's memory. Rows "pooled" say their share of the row "element" of the same
// board, measured in turns with it, by processor time (the thread's own; on Vulkan that of all
// threads, some of which are a software device): others may share the machine.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "body/analysis.hpp"
#include "has_vulkan.hpp"
#include "run_rows.hpp"
#include "tearing_board.hpp"

namespace sunder::bench {
namespace {

constexpr int kFrames = 31;

/// Where and how a frame is computed.
struct Place {
  const char* name;
  const char* backend;
  Route route;
};
constexpr Place kPlaces[] = {{"", "cpu", Route::factor},
                             {"vulkan-inverse/", "vulkan", Route::inverse},
                             {"vulkan-cg/", "vulkan", Route::cg}};

double own_ms(clockid_t of) {
  timespec t{};
  clock_gettime(of, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double middle(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

/// A board of one kind of volume, and its frames so far.
class PooledBoard {
 public:
  PooledBoard(const Place& place, Index cells, MaterialVolume volume, bool tears)
      : board_(cells),
        tears_(tears),
        clock_(place.route == Route::factor ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID) {
    Scene scene = board_.problem->scene();
    for (auto& [name, material] : scene.materials) material.volume = volume;
    scene.solver.route = place.route;
    scene.solver.backend = place.backend;
    problem_ = std::make_shared<const Problem>(std::move(scene));
    Needs needs;
    needs.stress = needs.yield = needs.damage = true;
    backend_ = create_backend(problem_, needs).backend;
    load_ = {board_.load_dofs, board_.load_values, {}};
    frame({});
  }

  void next() {
    for (double& f : load_.forces) f *= -1.01;
    const std::size_t event = ms_.size();
    const double start = own_ms(clock_);
    frame(tears_ ? board_.connected(event + 1).subspan(event) : std::span<const Index>{});
    ms_.push_back(own_ms(clock_) - start);
  }
  [[nodiscard]] double ms() const { return middle(ms_); }
  [[nodiscard]] double factor_mib() const {
    return static_cast<double>(fem::analyse(*problem_)->entries() * sizeof(double)) / (1 << 20);
  }

 private:
  void frame(std::span<const Index> broken) {
    if (!broken.empty()) backend_->destroy(broken);
    backend_->set_load(load_);
    backend_->solve();
    backend_->stress();
  }

  TearingBoard board_;
  bool tears_;
  clockid_t clock_;
  std::shared_ptr<const Problem> problem_;
  std::unique_ptr<Backend> backend_;
  Load load_;
  std::vector<double> ms_;
};

void pooled_row(benchmark::State& state, const Place& place, Index cells, bool tears) {
  for (auto _ : state) {
    PooledBoard element(place, cells, MaterialVolume::element, tears),
        pooled(place, cells, MaterialVolume::pooled, tears);
    for (int i = 0; i < kFrames; ++i) {
      element.next();
      pooled.next();
    }
    state.SetIterationTime(1e-3 * pooled.ms());
    state.counters["element_ms"] = element.ms();
    state.counters["pooled_ms"] = pooled.ms();
    state.counters["share"] = pooled.ms() / element.ms();
    state.counters["element_MiB"] = element.factor_mib();
    state.counters["pooled_MiB"] = pooled.factor_mib();
    state.counters["factor_share"] = pooled.factor_mib() / element.factor_mib();
  }
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  using namespace sunder::bench;
  for (const Place& place : kPlaces) {
    if (std::string(place.backend) == "vulkan" && !has_vulkan()) continue;
    for (const sunder::Index cells : {18, 36, 71}) {
      // An inverse is for small bodies.
      if (place.route == sunder::Route::inverse && cells > 36) continue;
      for (const bool tears : {false, true}) {
        const std::string name = std::string(tears ? "event/" : "frame/") + place.name + "pooled/" +
                                 std::to_string(6 * cells * cells);
        benchmark::RegisterBenchmark(
            name.c_str(), [=](benchmark::State& state) { pooled_row(state, place, cells, tears); })
            ->UseManualTime()
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
      }
    }
  }
  return run_rows(argc, argv);
}
