// SPDX-License-Identifier: Apache-2.0
// Motion beside what a user would pick instead (bench/motion_peers): the board's corner is pulled
// down at 80 mm/s until it tears (model A, one pass a step) and its lower part is torn off. The
// steps are those of a converged run; from each of its states everybody makes the next step, so
// that the error of stress is that of one step. Steps come every dt; what runs beside them has the
// time between.
//   motion/TETS/dt STEPS_A_SECOND/METHOD
// Counters by phase (pull, event: the step after a rupture, between, after: torn off): median
// milliseconds (ms), back-solves or iterations (it); over all: median and p99 of both, the median
// and 95 % quantile of the error of stress, the share of steps that a cap ended.
//   Of the project's own: factors made in the steps, bases made beside them and taken; "sunder" by
//   the factor, with grips_ms, what the forces of the grips
//   between frames take; "sunder inverse" by a dense inverse; the same and conjugate gradients on
//   the tangent on a Vulkan device, cg_it of them an iteration of Newton.
//   motion_balance/TETS/dt STEPS_A_SECOND: the board with damping and gravity until 90 elements are
//   gone: where the work went, in shares of it.
//   motion_hand/LAW: 10,000 steps of 1/200 s, at most 12 back-solves each, after a hand that
//   wanders at random within 25 mm at up to 200 mm/s and jumps anywhere there every 500 steps: how
//   many steps end with numbers that are none (nan), with inverted elements, capped, in parts, or
//   are not found (stuck); how many of the capped ones end with over 1e-6 more energy than they
//   began with and got by work (gained), of them where the hand jumps (gained_at_jumps), and the
//   largest share of the energy so won (most_gained).
//   motion_rest/TETS: steps of 1/200 s of a board that has come to rest, and of those before it
//   has.
//
//   bench_motion [Google Benchmark's options]
//
//   bench_motion --peers    the methods with their settings
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <map>
#include <thread>

#include "bench/motion_peers/motion_peer.hpp"
#include "body/hyperelastic_pass.hpp"
#ifdef SUNDER_GPU
#include "gpu/law_machine.hpp"
#endif
#include "quantile.hpp"
#include "run_rows.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSpeed = 80;  // [mm/s]
constexpr int kStepsAfter = 30;
enum Phase { pull, event, between, after };
constexpr std::array kPhases{"pull", "event", "between", "after"};

/// A step of the converged run.
struct Step {
  std::vector<Index> gone;        // since the step before
  solver::FiniteMotionPast past;  // before they left
  int euler = 0;                  // once they have
  Load load;
  Phase phase = pull;
  std::vector<double> end;    // displacement
  std::vector<Voigt> stress;  // there
  double largest = 0;
};

/// Live elements at or over their yield, by maximum shear stress.
std::vector<Index> over(const Problem& problem, std::span<const std::uint8_t> out,
                        std::span<const Voigt> stress) {
  std::vector<Index> of;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (!out[e] && problem.breakable(e) && max_shear(stress[e]) >= problem.yield(e)) {
      of.push_back(e);
    }
  }
  return of;
}

struct Course {
  explicit Course(Index cells, int a_second) : board(cells), dt(1.0 / a_second) {
    const Problem& problem = board.problem;
    std::vector<std::uint8_t> out(problem.mesh().tets.size(), 0);
    const fem::HyperelasticBody body{problem, board.laws, out};
    // Of 30,246 tetrahedra a step on the way of the tear does not come to 1e-9; 1e-7 is far below
    // the errors that the rows show.
    const double tolerance = cells > 36 ? 1e-7 : 1e-9;
    solver::FiniteMotion motion(body, board.node_mass,
                                {.tolerance = tolerance, .residual = 100 * tolerance});
    solver::RestingBody pieces(body);
    fem::HyperelasticPass pass(body);
    std::vector<Index> next;
    Phase now = pull;
    int left = kStepsAfter;
    for (int i = 1; i <= 4000 && left > 0; ++i) {
      Step step;
      step.gone = next;
      step.past = motion.past();
      step.phase = !next.empty() ? event : now;
      for (Index e : next) out[e] = 1;
      if (!next.empty()) {
        now = now == after ? after : between;
        motion.destroyed(next);
        pass.destroy(next);
        pieces.look();
        if (pieces.parts().pieces > 0 || !held_by_top(pieces)) now = after;
      }
      step.euler = motion.past().euler;
      step.load = board.pulled(kSpeed * i * dt);
      if (motion.step(step.load, dt).stuck) throw std::runtime_error("the course has no next step");
      step.end = motion.displacement();
      step.stress.resize(out.size());
      pass.run(step.end, {.stress = step.stress, .measure = StressMeasure::cauchy});
      next = over(problem, out, step.stress);
      for (const Voigt& s : step.stress) {
        step.largest = std::max(
            step.largest, std::sqrt(s.head<3>().squaredNorm() + 2 * s.tail<3>().squaredNorm()));
      }
      if (now == after) --left;
      steps.push_back(std::move(step));
    }
  }
  /// Whether the grip's corner still hangs on the supports.
  [[nodiscard]] bool held_by_top(const solver::RestingBody& pieces) const {
    // A grip holds its own piece, so that none is loose: look at what the supports reach.
    const Problem& problem = board.problem;
    std::vector<std::uint8_t> reached(problem.mesh().nodes.size(), 0);
    for (Index n = 0; n < problem.node_count(); ++n) reached[n] = problem.dof(n, 0) == kNone;
    for (bool grew = true; grew;) {
      grew = false;
      for (Index e = 0; e < problem.tet_count(); ++e) {
        if (pieces.out()[e]) continue;
        const auto& tet = problem.mesh().tets[e];
        const auto some = std::ranges::count_if(tet, [&](Index n) { return reached[n] != 0; });
        if (some == 0 || some == 4) continue;
        for (Index n : tet) reached[n] = 1;
        grew = true;
      }
    }
    for (Index n = 0; n < problem.node_count(); ++n) {
      if (std::ranges::binary_search(problem.gripped_dofs(), problem.dof(n, 0))) return reached[n];
    }
    return true;
  }

  MotionBoard board;
  double dt;
  std::vector<Step> steps;
};

const Course& course_of(Index cells, int a_second) {
  static std::map<std::pair<Index, int>, std::unique_ptr<Course>> courses;
  auto& course = courses[{cells, a_second}];
  if (!course) course = std::make_unique<Course>(cells, a_second);
  return *course;
}

/// What a method did, step by step.
class Record {
 public:
  explicit Record(const Course& course)
      : course_(course),
        out_(course.board.problem.mesh().tets.size(), 0),
        body_{course.board.problem, course.board.laws, out_},
        pass_(body_),
        stress_(out_.size()) {}

  void destroyed(const Step& step) {
    for (Index e : step.gone) out_[e] = 1;
    pass_.destroy(step.gone);
  }
  void add(const Step& step, double ms, int iterations, bool capped,
           const std::vector<double>& end) {
    pass_.run(end, {.stress = stress_, .measure = StressMeasure::cauchy});
    double change = 0;
    for (std::size_t e = 0; e < stress_.size(); ++e) {
      const Voigt d = stress_[e] - step.stress[e];
      change =
          std::max(change, std::sqrt(d.head<3>().squaredNorm() + 2 * d.tail<3>().squaredNorm()));
    }
    errors_.push_back(change / step.largest);
    ms_[step.phase].push_back(ms);
    its_[step.phase].push_back(iterations);
    capped_ += capped;
  }
  void report(benchmark::State& state) const {
    std::vector<double> all_ms, all_its;
    for (std::size_t p = 0; p < kPhases.size(); ++p) {
      state.counters[std::string(kPhases[p]) + "_ms"] = quantile(ms_[p], .5);
      state.counters[std::string(kPhases[p]) + "_it"] = quantile(its_[p], .5);
      state.counters[std::string(kPhases[p]) + "_steps"] = static_cast<double>(ms_[p].size());
      all_ms.insert(all_ms.end(), ms_[p].begin(), ms_[p].end());
      all_its.insert(all_its.end(), its_[p].begin(), its_[p].end());
    }
    state.counters["median_ms"] = quantile(all_ms, .5);
    state.counters["p99_ms"] = quantile(all_ms, .99);
    state.counters["median_it"] = quantile(all_its, .5);
    state.counters["p99_it"] = quantile(all_its, .99);
    state.counters["error_median"] = quantile(errors_, .5);
    state.counters["error_p95"] = quantile(errors_, .95);
    state.counters["capped"] = capped_ / static_cast<double>(all_ms.size());
    state.SetIterationTime(1e-3 * quantile(all_ms, .5));
  }

 private:
  const Course& course_;
  std::vector<std::uint8_t> out_;
  fem::HyperelasticBody body_;
  fem::HyperelasticPass pass_;
  std::vector<Voigt> stress_;
  std::array<std::vector<double>, kPhases.size()> ms_, its_;
  std::vector<double> errors_;
  double capped_ = 0;
};

/// Steps come every dt.
class Pace {
 public:
  explicit Pace(double dt)
      : dt_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(dt))) {}
  template <class Work>
  double time(Work&& work) {
    std::this_thread::sleep_until(next_);
    const auto start = Clock::now();
    work();
    const auto end = Clock::now();
    next_ = std::max(end, start + dt_);
    return std::chrono::duration<double, std::milli>(end - start).count();
  }

 private:
  Clock::duration dt_;
  Clock::time_point next_ = Clock::now();
};

/// How the project's own method runs.
struct Own {
  int cap = 0;
  Route route = Route::factor;
  bool vulkan = false;
  bool grips = false;  ///< and what forces of grips between frames take, each step
};

std::unique_ptr<solver::FiniteDevice> device_for(const Own& how,
                                                 const fem::HyperelasticBody& body) {
#ifdef SUNDER_GPU
  if (how.vulkan) return gpu::law_machine(body.problem, {}).device(body, how.route, 5);
#endif
  static_cast<void>(how);
  static_cast<void>(body);
  return nullptr;
}

void own_row(benchmark::State& state, Index cells, int a_second, const Own& how) {
  const Course& course = course_of(cells, a_second);
  for (auto _ : state) {
    std::vector<std::uint8_t> out(course.board.problem.mesh().tets.size(), 0);
    const fem::HyperelasticBody body{course.board.problem, course.board.laws, out};
    const auto device = device_for(how, body);
    solver::FiniteMotion motion(
        body, course.board.node_mass,
        {.most_iterations = how.cap, .inverse = how.route == Route::inverse}, device.get());
    Record record(course);
    Pace pace(course.dt);
    int factors = 0, bases = 0, back_solves = 0;
    std::vector<double> grips;
    for (const Step& step : course.steps) {
      if (step.past.dt > 0) motion.go_on_from(step.past);
      solver::FiniteMotionReport report;
      const double ms = pace.time([&] {
        if (!step.gone.empty()) {
          for (Index e : step.gone) out[e] = 1;
          motion.destroyed(step.gone);
        }
        report = motion.step(step.load, course.dt);
      });
      factors += report.factors;
      bases += report.bases;
      back_solves += report.back_solves;
      if (how.grips) {
        const auto start = Clock::now();
        benchmark::DoNotOptimize(motion.grip_stiffness(true));
        grips.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
      }
      record.destroyed(step);
      record.add(step, ms, report.back_solves, report.capped || report.stuck,
                 motion.displacement());
    }
    record.report(state);
    state.counters["factors"] = factors;
    state.counters["bases"] = bases;
    if (how.grips) state.counters["grips_ms"] = quantile(grips, .5);
    if (device && how.route == Route::cg) {
      state.counters["cg_it"] = static_cast<double>(device->inner_iterations()) / back_solves;
    }
  }
}

void peer_row(benchmark::State& state, const MotionKind& kind, Index cells, int a_second,
              double tolerance) {
  const Course& course = course_of(cells, a_second);
  for (auto _ : state) {
    const auto peer = kind.create(course.board, tolerance);
    Record record(course);
    Pace pace(course.dt);
    for (const Step& step : course.steps) {
      solver::FiniteMotionPast past = step.past;
      past.euler = step.euler;
      MotionSolved solved;
      const double ms = pace.time([&] {
        if (!step.gone.empty()) peer->destroy(step.gone);
        solved = peer->step(past, step.load, course.dt);
      });
      record.destroyed(step);
      record.add(step, ms, solved.iterations, !solved.ended, peer->displacement());
    }
    record.report(state);
  }
}

/// The board pulled until so many elements are gone, with damping and gravity: where the work went,
/// in shares of it. `open`: what the terms leave, where what the iteration has left counts as none.
void balance_row(benchmark::State& state, Index cells, int a_second, int ruptures) {
  const double dt = 1.0 / a_second;
  for (auto _ : state) {
    const MotionBoard board(cells);
    std::vector<std::uint8_t> out(board.problem.mesh().tets.size(), 0);
    const fem::HyperelasticBody body{board.problem, board.laws, out};
    solver::FiniteMotion motion(body, board.node_mass,
                                {.damping = 1, .gravity = Vec3(0, -9810, 0)});
    fem::HyperelasticPass pass(body);
    std::vector<Voigt> stress(out.size());
    std::vector<double> ms;
    std::vector<Index> next;
    double gone = 0, steps = 0, stuck = 0;
    for (int i = 1; i <= 10 * a_second && gone < ruptures && stuck == 0; ++i, ++steps) {
      for (Index e : next) out[e] = 1;
      gone += static_cast<double>(next.size());
      const auto start = Clock::now();
      if (!next.empty()) motion.destroyed(next);
      stuck += motion.step(board.pulled(kSpeed * i * dt), dt).stuck;
      ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
      pass.destroy(next);
      pass.run(motion.displacement(), {.stress = stress, .measure = StressMeasure::cauchy});
      next = over(board.problem, out, stress);
    }
    const solver::FiniteMotionBalance sum = motion.sum();
    const double held = motion.kinetic_energy() + motion.strain_energy() + motion.gravity_energy();
    const double terms = held + sum.damped + sum.scheme + sum.broken;
    state.SetIterationTime(1e-3 * quantile(ms, .5));
    state.counters["ruptures"] = gone;
    state.counters["steps"] = steps;
    state.counters["stuck"] = stuck;
    state.counters["work"] = sum.work;
    state.counters["held"] = held / sum.work;
    state.counters["damped"] = sum.damped / sum.work;
    state.counters["scheme"] = sum.scheme / sum.work;
    state.counters["broken"] = sum.broken / sum.work;
    state.counters["unsolved"] = sum.unsolved / sum.work;
    state.counters["open"] = (sum.work - terms) / sum.work;
    state.counters["rounding"] = (sum.work - terms - sum.unsolved) / sum.work;
  }
}

/// Within a ball, from a seed of its own: the same on every machine.
class Hand {
 public:
  Vec3 next(double dt, bool jump) {
    if (jump) {
      at_ = kReach * inside();
      return at_;
    }
    speed_ += 0.2 * kFastest * inside();
    if (speed_.norm() > kFastest) speed_ *= kFastest / speed_.norm();
    at_ += dt * speed_;
    if (at_.norm() > kReach) {
      at_ *= kReach / at_.norm();
      speed_ *= -0.5;
    }
    return at_;
  }

 private:
  static constexpr double kReach = 25, kFastest = 200;  // [mm], [mm/s]
  double uniform() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11U) / 4503599627370496.0 - 1;
  }
  Vec3 inside() {
    for (;;) {
      const Vec3 x(uniform(), uniform(), uniform());
      if (x.norm() <= 1) return x;
    }
  }
  std::uint64_t state_ = 20130727;
  Vec3 at_ = Vec3::Zero(), speed_ = Vec3::Zero();
};

void hand_row(benchmark::State& state, const Law& law) {
  constexpr int kSteps = 10000, kBetweenJumps = 500, kCap = 12;
  constexpr double kDt = 1.0 / 200;
  for (auto _ : state) {
    const MotionBoard board(18);
    const auto laws = fem::one_law(board.problem, law);
    const fem::HyperelasticBody body{board.problem, laws, {}};
    solver::FiniteMotion motion(body, board.node_mass, {.most_iterations = kCap});
    fem::HyperelasticPass pass(body);
    Hand hand;
    Load load = board.pulled(0);
    std::vector<double> ms;
    double nan = 0, inverted = 0, capped = 0, parts = 0, stuck = 0, most_inverted = 0;
    double gained = 0, gained_at_jumps = 0, most_gained = 0;
    for (int i = 1; i <= kSteps; ++i) {
      const Vec3 at = hand.next(kDt, i % kBetweenJumps == 0);
      for (std::size_t g = 0; g < load.displacements.size(); ++g) {
        load.displacements[g] = at[static_cast<Eigen::Index>(board.axis[g])];
      }
      const auto start = Clock::now();
      const auto report = motion.step(load, kDt);
      ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
      const solver::FiniteMotionBalance& of = report.balance;
      const double gain = -(of.damped + of.scheme + of.unsolved) /
                          (motion.kinetic_energy() + motion.strain_energy());
      if (report.capped && !report.stuck) {
        gained += gain > 1e-6;
        gained_at_jumps += gain > 1e-6 && i % kBetweenJumps == 0;
        most_gained = std::max(most_gained, gain);
      }
      capped += report.capped;
      parts += report.parts > 1;
      stuck += report.stuck;
      nan += !std::ranges::all_of(motion.displacement(), [](double u) { return std::isfinite(u); });
      const Index turned =
          pass.run(motion.displacement(), {.deformation = true}).deformation.inverted;
      inverted += turned > 0;
      most_inverted = std::max(most_inverted, static_cast<double>(turned));
    }
    state.SetIterationTime(1e-3 * quantile(ms, .5));
    state.counters["nan"] = nan;
    state.counters["inverted"] = inverted;
    state.counters["most_inverted"] = most_inverted;
    state.counters["capped"] = capped;
    state.counters["gained"] = gained;
    state.counters["gained_at_jumps"] = gained_at_jumps;
    state.counters["most_gained"] = most_gained;
    state.counters["parts"] = parts;
    state.counters["stuck"] = stuck;
    state.counters["median_ms"] = quantile(ms, .5);
    state.counters["p99_ms"] = quantile(ms, .99);
  }
}

/// The board hangs by its upper edge and comes to rest; what its steps take then, and before.
void rest_row(benchmark::State& state, Index cells) {
  constexpr int kMost = 4000, kAtRest = 1000;
  constexpr double kDt = 1.0 / 200;
  for (auto _ : state) {
    const MotionBoard board(cells);
    const fem::HyperelasticBody body{board.problem, board.laws, {}};
    solver::FiniteMotion motion(body, board.node_mass,
                                {.damping = 20, .viscosity = 5e-4, .gravity = Vec3(0, -9810, 0)});
    std::vector<double> moving, resting;
    double back_solves = 0;
    const auto& u = motion.displacement();
    std::vector<double> at_rest;
    double same = 1;
    for (int i = 0; i < kMost && resting.size() < kAtRest; ++i) {
      const auto start = Clock::now();
      const auto report = motion.step(board.pulled(0), kDt);
      const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
      (report.still ? resting : moving).push_back(ms);
      if (!report.still) continue;
      back_solves += report.back_solves;
      if (at_rest.empty()) at_rest = u;
      same *= at_rest == u;
    }
    state.SetIterationTime(1e-3 * quantile(resting, .5));
    state.counters["moving_steps"] = static_cast<double>(moving.size());
    state.counters["moving_ms"] = quantile(moving, .5);
    state.counters["rest_steps"] = static_cast<double>(resting.size());
    state.counters["rest_ms"] = quantile(resting, .5);
    state.counters["rest_back_solves"] = back_solves;
    state.counters["same_bits"] = same;
  }
}

std::string power(double tolerance) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0e", tolerance);
  return text;
}

void add(const std::string& name, const std::function<void(benchmark::State&)>& run) {
  const auto guarded = [run](benchmark::State& state) {
    try {
      run(state);
    } catch (const std::runtime_error& error) {
      state.SkipWithError(error.what());
    }
  };
  benchmark::RegisterBenchmark(name.c_str(), guarded)
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

std::vector<MotionKind> peers() {
  return {motion_newton(), motion_projective(), motion_vertex_blocks()};
}

void register_rows() {
  for (const Index cells : {18, 36, 71}) {
    for (const int a_second : {200, 1000}) {
      if (cells > 36 && a_second == 1000) continue;  // the converged run alone takes long
      const std::string board =
          "motion/" + std::to_string(6 * cells * cells) + "/dt " + std::to_string(a_second) + "/";
      const int cap = a_second == 200 ? 12 : 8;
      add(board + "sunder", [=](auto& s) { own_row(s, cells, a_second, {.grips = true}); });
      add(board + "sunder capped", [=](auto& s) { own_row(s, cells, a_second, {.cap = cap}); });
      const auto own = [&](const std::string& name, Route route, bool vulkan) {
        const Own how{.route = route, .vulkan = vulkan};
        add(board + name, [=](auto& s) { own_row(s, cells, a_second, how); });
      };
      if (cells == 18) own("sunder inverse", Route::inverse, false);
#ifdef SUNDER_GPU
      if (cells == 18) own("sunder vulkan inverse", Route::inverse, true);
      if (cells <= 36) own("sunder vulkan cg", Route::cg, true);  // else hours on lavapipe
#endif
      for (const MotionKind& kind : peers()) {
        for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
          add(board + kind.name + "/" + power(tolerance),
              [=](auto& s) { peer_row(s, kind, cells, a_second, tolerance); });
        }
      }
    }
  }
  for (const int a_second : {200, 1000}) {
    add("motion_balance/1944/dt " + std::to_string(a_second),
        [=](auto& s) { balance_row(s, 18, a_second, 90); });
  }
  for (const Index cells : {18, 36}) {
    add("motion_rest/" + std::to_string(6 * cells * cells), [=](auto& s) { rest_row(s, cells); });
  }
  for (const char* law : {"neo-hookean", "corotated", "saint-venant-kirchhoff"}) {
    const Law* of = find_law(law);
    add(std::string("motion_hand/") + law, [=](auto& s) { hand_row(s, *of); });
  }
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == "--peers") {
    for (const auto& kind : sunder::bench::peers()) {
      std::printf("%s\t%s\n", kind.name.c_str(), kind.settings.c_str());
    }
    return 0;
  }
  sunder::bench::register_rows();
  return sunder::bench::run_rows(argc, argv);
}
