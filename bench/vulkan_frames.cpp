// SPDX-License-Identifier: Apache-2.0
// The board of Table 1 as a user meets it: a quiet frame, a frame with one fracture, the start.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>

#include "cpu_reference/cpu_reference.hpp"
#include "gpu/vulkan_backend.hpp"
#include "sunder/simulation.hpp"
#include "support/loads.hpp"
#include "support/sequences.hpp"
#include "vulkan_rows.hpp"

namespace sunder::bench {
namespace {

constexpr std::size_t kFractures = 20;  // of one backend, then a fresh one

std::shared_ptr<const Problem> board(const std::string& backend, bool fp64, int device,
                                     Update update = Update::automatic) {
  Scene scene = test::pulled_board();
  scene.fracture.model = FractureModel::a;
  scene.solver.backend = backend;
  if (backend == "vulkan") {
    scene.solver.precision = fp64 ? Precision::fp64 : Precision::fp32;
    scene.solver.device = device;
  }
  scene.solver.update = update;
  if (update == Update::eager) scene.solver.route = Route::inverse;
  return std::make_shared<const Problem>(std::move(scene));
}

std::unique_ptr<Backend> create(const std::shared_ptr<const Problem>& problem) {
  return problem->scene().solver.backend == "cpu"
             ? cpu_reference::create(problem, needs_of(*problem))
             : gpu::create(problem, needs_of(*problem), {});
}

/// The work of a frame on one backend: a load, its solution, stress with the summary.
class Frames {
 public:
  explicit Frames(std::shared_ptr<const Problem> problem)
      : problem_(std::move(problem)), crack_(test::crack_sequence(*problem_, kFractures, 10)) {
    renew();
  }
  void renew() {
    backend_.reset();
    backend_ = create(problem_);
    broken_ = 0;
    quiet();
  }
  /// The load grows and falls a little, as a hand's does.
  void quiet() {
    backend_->set_load(test::corner_pull(*problem_, Vec3(0, -60 - ++frames_ % 7, 0)));
    backend_->solve();
    benchmark::DoNotOptimize(backend_->stress());
  }
  /// That a frame moves on its device at least; 0: there is none.
  [[nodiscard]] double bytes(bool fracture) const {
    const solver::FrameCost cost = gpu::predicted(*backend_);
    return fracture ? cost.fracture.bytes : cost.quiet.bytes;
  }
  void prepare_fracture() {
    if (broken_ == crack_.size()) renew();
  }
  void fracture() {
    backend_->destroy({&crack_[broken_++], 1});
    backend_->solve();
    benchmark::DoNotOptimize(backend_->stress());
  }

 private:
  std::shared_ptr<const Problem> problem_;
  std::vector<Index> crack_;
  std::unique_ptr<Backend> backend_;
  std::size_t broken_ = 0;
  int frames_ = 0;
};

void board_frame(benchmark::State& state, const Rows& rows, const std::string& name, bool fp64,
                 bool fracture, Update update = Update::automatic) {
  Frames vulkan(board("vulkan", fp64, rows.device, update)), cpu(board("cpu", true, kNone, update));
  Work work;
  work.warm_up = true;
  work.bytes = vulkan.bytes(fracture);
  if (fracture) {
    work.prepare = [&] { vulkan.prepare_fracture(); };
    work.run = [&] { vulkan.fracture(); };
    work.prepare_reference = [&] { cpu.prepare_fracture(); };
    work.reference = [&] { cpu.fracture(); };
  } else {
    work.run = [&] { vulkan.quiet(); };
    work.reference = [&] { cpu.quiet(); };
  }
  rows.table.measure(state, name, work);
}

/// A cascade of scattered fractures, one a frame, from the intact board on. Frames that take a base
/// which a thread has computed meanwhile stand out in the worst one.
class Cascade {
 public:
  explicit Cascade(std::shared_ptr<const Problem> problem)
      : problem_(std::move(problem)), sequence_(test::scattered_sequence(*problem_, 640)) {}
  void run() {
    const auto backend = create(problem_);
    backend->set_load(test::corner_pull(*problem_, Vec3(0, -60, 0)));
    backend->solve();
    frames_.clear();
    for (const Index element : sequence_) {
      const auto start = std::chrono::steady_clock::now();
      backend->destroy({&element, 1});
      backend->solve();
      benchmark::DoNotOptimize(backend->stress());
      const std::chrono::duration<double, std::milli> time =
          std::chrono::steady_clock::now() - start;
      frames_.push_back(time.count());
    }
  }
  [[nodiscard]] double first() const { return median({frames_.begin(), frames_.begin() + 20}); }
  [[nodiscard]] double last() const { return median({frames_.end() - 20, frames_.end()}); }
  [[nodiscard]] double worst() const { return *std::max_element(frames_.begin(), frames_.end()); }

 private:
  static double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
  }
  std::shared_ptr<const Problem> problem_;
  std::vector<Index> sequence_;
  std::vector<double> frames_;  // [ms]
};

/// Milliseconds are those of all frames; the counters tell first, last and worst ones. The
/// reference runs in the first repetition alone: `cpu` has it for those after.
void board_cascade(benchmark::State& state, const Rows& rows, const std::string& name, bool fp64,
                   std::optional<Cascade>& cpu) {
  Cascade vulkan(board("vulkan", fp64, rows.device));
  if (!cpu) cpu.emplace(board("cpu", true, kNone));
  Work work;
  work.run = [&] { vulkan.run(); };
  work.reference = [&] { cpu->run(); };
  rows.table.measure(state, name, work);
  state.counters["first_ms"] = vulkan.first();
  state.counters["last_ms"] = vulkan.last();
  state.counters["worst_ms"] = vulkan.worst();
  state.counters["cpu_first_ms"] = cpu->first();
  state.counters["cpu_last_ms"] = cpu->last();
}

/// A cut through the board on route cg: the lower half is held by destroyed elements only.
void board_cut_by_cg(benchmark::State& state, const Rows& rows, const std::string& name) {
  const auto cut_board = [&](const std::string& backend) {
    Scene scene = board(backend, true, rows.device)->scene();
    scene.solver.route = Route::cg;
    return std::make_shared<const Problem>(std::move(scene));
  };
  const auto on_vulkan = cut_board("vulkan"), on_cpu = cut_board("cpu");
  const auto cut = test::elements_across(on_cpu->mesh(), 26.5);
  const auto prepared = [&](const std::shared_ptr<const Problem>& problem) {
    auto backend = create(problem);
    backend->set_load(test::corner_pull(*problem, Vec3(0, -60, 0)));
    backend->solve();
    backend->destroy(cut);
    return backend;
  };
  std::unique_ptr<Backend> vulkan, cpu;
  int iterations = 0;
  Work work;
  work.prepare = [&] { vulkan = prepared(on_vulkan); };
  work.run = [&] { iterations = vulkan->solve().iterations; };
  work.prepare_reference = [&] { cpu = prepared(on_cpu); };
  work.reference = [&] { cpu->solve(); };
  rows.table.measure(state, name, work);
  state.counters["iterations"] = iterations;
}

/// Runs this program again as a process that only starts up, with a shader cache of its own.
double start_up_of_child(bool fp64, int device, const std::filesystem::path& cache) {
  const std::string command = "MESA_SHADER_CACHE_DIR='" + cache.string() + "' '" +
                              std::filesystem::read_symlink("/proc/self/exe").string() +
                              "' --start-up=" + (fp64 ? "fp64" : "fp32") +
                              " --device=" + std::to_string(device);
  std::FILE* pipe = popen(command.c_str(), "r");
  double ms = 0;
  const int read = pipe ? std::fscanf(pipe, "%lf", &ms) : 0;
  if (!pipe || pclose(pipe) != 0 || read != 1) throw std::runtime_error("no start-up time");
  return ms;
}

void start_up(benchmark::State& state, const Rows& rows, const std::string& name, bool fp64,
              bool cold) {
  const auto cache = std::filesystem::temp_directory_path() / "sunder-bench-shaders";
  std::filesystem::remove_all(cache);
  double ms = 0;
  if (!cold) start_up_of_child(fp64, rows.device, cache);
  Work work;
  work.prepare = [&] {
    if (cold) std::filesystem::remove_all(cache);
  };
  work.run = [&] { ms = start_up_of_child(fp64, rows.device, cache); };
  work.milliseconds = [&] { return ms; };
  const auto problem = board("cpu", true, kNone);
  work.reference = [&] { Frames frames(problem); };
  rows.table.measure(state, name, work);
  std::filesystem::remove_all(cache);
}

}  // namespace

double start_up_ms(bool fp64, int device) {
  const auto problem = board("vulkan", fp64, device);
  const auto start = std::chrono::steady_clock::now();
  const Frames frames(problem);
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

void register_frame_rows(const Rows& rows) {
  const std::string cut = "board_cut_by_cg/fp64";
  add_row(cut, [=, &rows](auto& s) { board_cut_by_cg(s, rows, cut); });
  const std::string eager = "board_fracture_frame_eager/fp64";
  add_row(eager, [=, &rows](auto& s) { board_frame(s, rows, eager, true, true, Update::eager); });
  for (const bool fp64 : {false, true}) {
    const std::string precision = fp64 ? "/fp64" : "/fp32";
    for (const bool fracture : {false, true}) {
      const std::string name =
          (fracture ? "board_fracture_frame" : "board_quiet_frame") + precision;
      add_row(name, [=, &rows](auto& s) { board_frame(s, rows, name, fp64, fracture); });
    }
    const std::string cascade = "board_cascade_640" + precision;
    const auto cpu = std::make_shared<std::optional<Cascade>>();
    add_row(cascade, [=, &rows](auto& s) { board_cascade(s, rows, cascade, fp64, *cpu); });
    for (const bool cold : {true, false}) {
      const std::string name = (cold ? "start_up_cold" : "start_up_warm") + precision;
      add_row(
          name, [=, &rows](auto& s) { start_up(s, rows, name, fp64, cold); }, 2.0);
    }
  }
}

}  // namespace sunder::bench
