// SPDX-License-Identifier: Apache-2.0
// The program as a user runs it: whole scenes, start to files, as one process.
// --benchmark_repetitions=5 for the minimum of five.
#include <benchmark/benchmark.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <filesystem>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

double child_cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

bool run_program(const std::string& scene, const std::string& out) {
  std::vector<std::string> words{SUNDER_PROGRAM, "run", scene, "--out", out, "--quiet"};
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", 1, 0);
  pid_t pid = 0;
  const int spawned = posix_spawn(&pid, SUNDER_PROGRAM, &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  return spawned == 0 && waitpid(pid, &status, 0) == pid && WIFEXITED(status) &&
         WEXITSTATUS(status) == 0;
}

void whole_run(benchmark::State& state, const std::string& name) {
  const fs::path out = fs::temp_directory_path() / ("sunder-bench-" + name);
  const double before = child_cpu_seconds();
  for (auto _ : state) {
    if (!run_program(std::string(SUNDER_SCENES) + "/" + name + ".toml", out.string())) {
      state.SkipWithError("the program failed");
      break;
    }
  }
  state.counters["cpu_s"] =
      benchmark::Counter(child_cpu_seconds() - before, benchmark::Counter::kAvgIterations);
  fs::remove_all(out);
}

BENCHMARK_CAPTURE(whole_run, board_pull_a, std::string("board-pull-a"))
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);
BENCHMARK_CAPTURE(whole_run, board_pull_b, std::string("board-pull-b"))
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);
BENCHMARK_CAPTURE(whole_run, notch_b, std::string("notch-b"))
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

}  // namespace
