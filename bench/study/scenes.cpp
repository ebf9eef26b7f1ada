// SPDX-License-Identifier: Apache-2.0
// Error against run time on the scenes themselves: every method and tolerance runs a scene to its
// end; one CSV row each. Errors are those of the last frame against a run by conjugate gradients in
// fp64 whose solution is refined to 1e-10. Verdicts as in the stability study (method.hpp).
//   bench_scenes FILE [--seconds=S] [--tolerances=T,...] [SCENE...]        all scenes by default
// A run that takes more than S seconds (60) ends there and is reported as "over budget"; the
// method's further tolerances are then left out for this scene.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "app/input/scene_toml.hpp"
#include "bench/study/method.hpp"
#include "body/element.hpp"
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
  bool over_budget = false;      ///< ended before the scene did
  double rounding = 0;           ///< stress error that rounding u to fp32 alone costs
};

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

Run run_scene(const Problem& stated, const SolverOptions& options, double budget) {
  const auto start = Clock::now();
  Scene scene = stated.scene();
  scene.solver = options;
  const auto problem = std::make_shared<Problem>(std::move(scene));
  Needs needs = needs_of(*problem);
  needs.stress = true;  // it is what errors are measured in
  Simulation simulation(problem, create_backend(problem, needs).backend);
  Run run;
  const auto in_time = [&] { return seconds_since(start) < budget; };
  simulation.observe_events([&](std::span<const DestroyedElement>) { return in_time(); });
  std::vector<double> ms;
  while (!simulation.done() && in_time()) {
    const StepReport step = simulation.step();
    ms.push_back(step.times.total / (step.events + 1));
    run.polished += step.polished;
  }
  run.frame_ms = median(ms);
  run.over_budget = !simulation.done() || simulation.interrupted();
  for (const Vec3& u : simulation.displacement()) run.u.insert(run.u.end(), {u.x(), u.y(), u.z()});
  run.stress = simulation.stress();
  const auto destroyed = simulation.backend().destroyed();
  run.destroyed.assign(destroyed.begin(), destroyed.end());
  for (const DestroyedElement& d : simulation.destroyed()) run.fractures.push_back(d.element);
  return run;
}

double rounding_of(const Problem& problem, const Run& run) {
  std::vector<double> rounded;
  for (double x : run.u) rounded.push_back(static_cast<double>(static_cast<float>(x)));
  std::vector<Voigt> stress;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    stress.push_back(fem::stress(problem.shape(e), problem.small_strain(e),
                                 fem::corner_displacement(problem.mesh(), e, rounded)));
  }
  return test::stress_error(run.destroyed, stress, run.stress);
}

std::string verdict(const Run& run, const Run& reference, const SolverOptions& options,
                    double stress_error) {
  if (run.fractures != reference.fractures) return "other fractures";
  if (!(stress_error <= options.tolerance)) {
    const bool single = options.precision == Precision::fp32;
    return single && stress_error <= 4 * reference.rounding ? "rounded" : "WRONG";
  }
  return run.polished ? "polished" : "ok";
}

void write_numbers(std::ostream& out, const Problem& problem, const Run& run, const Run& reference,
                   const SolverOptions& options) {
  out << run.frame_ms << ',';
  if (run.over_budget) {
    out << ",," << run.fractures.size() << ",over budget,\n";
    return;
  }
  const double stress_error = test::stress_error(reference.destroyed, run.stress, reference.stress);
  out << test::displacement_error(problem.mesh(), reference.destroyed, run.u, reference.u) << ','
      << stress_error << ',' << run.fractures.size() << ','
      << verdict(run, reference, options, stress_error) << ",\n";
}

/// Verdict "other fractures": the list differs, so that errors compare nothing. Returns whether the
/// run came to its end.
bool row(std::ostream& out, const std::string& scene, const Method& method, double budget,
         const Problem& problem, const Run& reference) {
  out << scene << ',' << method.name << ',' << method.options.tolerance << ',';
  bool ended = true;
  try {
    const Run run = run_scene(problem, method.options, budget);
    ended = !run.over_budget;
    write_numbers(out, problem, run, reference, method.options);
  } catch (const Error& error) {
    std::string reason = error.what();
    std::replace(reason.begin(), reason.end(), '"', '\'');
    out << ",,,,refused,\"" << reason << "\"\n";
  }
  out.flush();
  return ended;
}

struct Options {
  double seconds = 60;
  std::vector<double> tolerances{1e-4, 1e-2, 1e-8};
  std::vector<std::filesystem::path> files;
};

void study(std::ostream& out, const std::filesystem::path& file, const Options& options) {
  const auto problem = app::read_problem(file);
  // Conjugate gradients go by the residual, element by element: they come further than any update.
  SolverOptions exact;
  exact.backend = "cpu";
  exact.route = Route::cg;
  exact.tolerance = 1e-10;
  Run reference = run_scene(*problem, exact, 1e9);
  reference.rounding = rounding_of(*problem, reference);
  for (const Method& method : methods()) {
    Method at = method;
    for (double tolerance : options.tolerances) {
      std::fprintf(stderr, "\r%s: %s, %g        ", file.stem().c_str(), method.name.c_str(),
                   tolerance);
      at.options.tolerance = tolerance;
      if (!row(out, file.stem().string(), at, options.seconds, *problem, reference)) break;
    }
  }
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.starts_with("--seconds=")) {
      options.seconds = std::stod(word.substr(10));
    } else if (word.starts_with("--tolerances=")) {
      options.tolerances.clear();
      std::istringstream list(word.substr(13));
      for (std::string one; std::getline(list, one, ',');)
        options.tolerances.push_back(std::stod(one));
    } else {
      options.files.emplace_back(word);
    }
  }
  if (!options.files.empty()) return options;
  for (const auto& entry : std::filesystem::directory_iterator(SUNDER_SCENES)) {
    if (entry.path().extension() == ".toml") options.files.push_back(entry.path());
  }
  std::sort(options.files.begin(), options.files.end());
  return options;
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: bench_scenes FILE [--seconds=S] [--tolerances=T,...] [SCENE...]\n";
    return 2;
  }
  std::ofstream out(argv[1]);
  out << "scene,method,tolerance,frame_ms,u_error,stress_error,fractures,verdict,reason\n";
  try {
    const auto options = sunder::bench::read_options(argc, argv);
    for (const auto& file : options.files) sunder::bench::study(out, file, options);
  } catch (const sunder::Error& error) {
    std::cerr << error.what() << '\n';
    return 3;
  } catch (const std::invalid_argument&) {
    std::cerr << "bench_scenes: --seconds and --tolerances take numbers\n";
    return 2;
  }
  out.close();
  std::fputc('\n', stderr);
  if (!out) std::cerr << "cannot write " << argv[1] << '\n';
  return out ? 0 : 3;
}
