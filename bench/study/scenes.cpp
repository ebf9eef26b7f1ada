// SPDX-License-Identifier: Apache-2.0
// Error against run time on the scenes themselves: every method and tolerance runs a scene to its
// end; one CSV row each. Errors are those of the last frame against a run by the factor in fp64
// (itself within 1e-8 of a fresh factorisation, tests/cpu_reference) whose solution is refined to
// 1e-10.
//   bench_scenes FILE [SCENE...]        all scenes by default
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "app/input/scene_toml.hpp"
#include "bench/study/method.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"
#include "support/accuracy.hpp"

namespace sunder::bench {
namespace {

struct Run {
  std::vector<double> u;
  std::vector<Voigt> stress;
  std::vector<std::uint8_t> destroyed;
  std::vector<Index> fractures;  ///< in order
  double frame_ms = 0;           ///< median over steps of time per frame
  int polished = 0;              ///< steps
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

Run run_scene(const Problem& stated, const SolverOptions& options) {
  Scene scene = stated.scene();
  scene.solver = options;
  const auto problem = std::make_shared<Problem>(std::move(scene));
  Needs needs = needs_of(*problem);
  needs.stress = true;  // it is what errors are measured in
  Simulation simulation(problem, create_backend(problem, needs).backend);
  Run run;
  std::vector<double> ms;
  while (!simulation.done()) {
    const StepReport step = simulation.step();
    ms.push_back(step.times.total / (step.events + 1));
    run.polished += step.polished;
  }
  run.frame_ms = median(ms);
  for (const Vec3& u : simulation.displacement()) run.u.insert(run.u.end(), {u.x(), u.y(), u.z()});
  run.stress = simulation.stress();
  const auto destroyed = simulation.backend().destroyed();
  run.destroyed.assign(destroyed.begin(), destroyed.end());
  for (const DestroyedElement& d : simulation.destroyed()) run.fractures.push_back(d.element);
  return run;
}

constexpr double kLongRun = 30;  // s; a method that takes longer runs a scene once

/// Verdict "other fractures": the list differs, so that errors compare nothing. Returns seconds.
double row(std::ostream& out, const std::string& scene, const Method& method, double tolerance,
           const Problem& problem, const Run& reference) {
  SolverOptions options = method.options;
  options.tolerance = tolerance;
  out << scene << ',' << method.name << ',' << tolerance << ',';
  const auto start = std::chrono::steady_clock::now();
  try {
    const Run run = run_scene(problem, options);
    const bool same = run.fractures == reference.fractures;
    out << run.frame_ms << ','
        << test::displacement_error(problem.mesh(), reference.destroyed, run.u, reference.u) << ','
        << test::stress_error(reference.destroyed, run.stress, reference.stress) << ','
        << run.fractures.size() << ','
        << (!same          ? "other fractures"
            : run.polished ? "polished"
                           : "ok")
        << ",\n";
  } catch (const Error& error) {
    std::string reason = error.what();
    std::replace(reason.begin(), reason.end(), '"', '\'');
    out << ",,,,refused,\"" << reason << "\"\n";
  }
  out.flush();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void study(std::ostream& out, const std::filesystem::path& file) {
  const auto problem = app::read_problem(file);
  SolverOptions exact;
  exact.backend = "cpu";
  exact.route = Route::factor;
  exact.tolerance = 1e-10;
  const Run reference = run_scene(*problem, exact);
  bool vulkan = false;
  for (const DeviceInfo& device : devices()) vulkan |= device.backend == "vulkan";
  for (const Method& method : methods(vulkan)) {
    for (double tolerance : {1e-4, 1e-2, 1e-8}) {
      std::fprintf(stderr, "\r%s: %s, %g        ", file.stem().c_str(), method.name.c_str(),
                   tolerance);
      if (row(out, file.stem().string(), method, tolerance, *problem, reference) > kLongRun) break;
    }
  }
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: bench_scenes FILE [SCENE...]\n";
    return 2;
  }
  std::vector<std::filesystem::path> files(argv + 2, argv + argc);
  if (files.empty()) {
    for (const auto& entry : std::filesystem::directory_iterator(SUNDER_SCENES)) {
      if (entry.path().extension() == ".toml") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
  }
  std::ofstream out(argv[1]);
  out << "scene,method,tolerance,frame_ms,u_error,stress_error,fractures,verdict,reason\n";
  try {
    for (const auto& file : files) sunder::bench::study(out, file);
  } catch (const sunder::Error& error) {
    std::cerr << error.what() << '\n';
    return 3;
  }
  out.close();
  std::fputc('\n', stderr);
  if (!out) std::cerr << "cannot write " << argv[1] << '\n';
  return out ? 0 : 3;
}
