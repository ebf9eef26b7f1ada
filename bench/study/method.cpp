// SPDX-License-Identifier: Apache-2.0
#include "bench/study/method.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "bench/has_vulkan.hpp"
#include "bench/study/yardstick.hpp"
#include "body/pieces.hpp"
#include "cpu_reference/plain/plain.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"
#include "support/accuracy.hpp"
#include "support/loads.hpp"

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

Method method(const char* name, const char* backend, Route route, Update update,
              Precision precision) {
  Method m{name, {}};
  m.options.backend = backend;
  m.options.route = route;
  m.options.update = update;
  m.options.precision = precision;
  return m;
}

std::vector<std::uint8_t> marked(const Problem& problem, std::span<const Index> removed) {
  std::vector<std::uint8_t> destroyed(static_cast<std::size_t>(problem.tet_count()), 0);
  for (Index e : removed) destroyed[static_cast<std::size_t>(e)] = 1;
  return destroyed;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// Frames of the whole sequence; returns the reports of the last one and of all.
SolveReport run_frames(Backend& backend, const Load& load, std::span<const Index> removed,
                       std::size_t batch, Outcome& outcome) {
  std::vector<double> ms;
  SolveReport last;
  bool polished = false;
  for (std::size_t done = 0; done < removed.size() || ms.empty();) {
    const std::size_t next = std::min(done + batch, removed.size());
    const auto start = Clock::now();
    if (next > done) backend.destroy(removed.subspan(done, next - done));
    backend.set_load(load);
    last = backend.solve();
    backend.stress();
    ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    polished |= last.polished;
    done = next;
  }
  outcome.first_ms = ms.front();
  outcome.median_ms = median(ms);
  outcome.verdict = polished ? "polished" : "ok";
  return last;
}

void compare(const Backend& backend, const Problem& problem, const Reference& reference,
             Outcome& outcome) {
  std::vector<double> u(problem.dofs().size());
  std::vector<Voigt> stress(problem.mesh().tets.size());
  backend.read_displacement(u);
  backend.read_stress(stress);
  outcome.u_error = test::displacement_error(problem.mesh(), reference.ignored, u, reference.u);
  outcome.stress_error = test::stress_error(reference.ignored, stress, reference.stress);
}

}  // namespace

std::vector<Method> methods() {
  constexpr auto inverse = Route::inverse, condensed = Route::condensed, factor = Route::factor,
                 cg = Route::cg;
  constexpr auto eager = Update::eager, deferred = Update::deferred;
  constexpr auto fp32 = Precision::fp32, fp64 = Precision::fp64;
  std::vector<Method> list{method("cpu inverse eager fp64", "cpu", inverse, eager, fp64),
                           method("cpu inverse deferred fp64", "cpu", inverse, deferred, fp64),
                           method("cpu condensed deferred fp64", "cpu", condensed, deferred, fp64),
                           method("cpu factor deferred fp64", "cpu", factor, deferred, fp64),
                           method("cpu cg fp64", "cpu", cg, Update::automatic, fp64)};
  if (has_vulkan()) {
    for (const auto& m :
         {method("vulkan inverse eager fp64", "vulkan", inverse, eager, fp64),
          method("vulkan inverse deferred fp32", "vulkan", inverse, deferred, fp32),
          method("vulkan inverse deferred fp64", "vulkan", inverse, deferred, fp64),
          method("vulkan condensed deferred fp32", "vulkan", condensed, deferred, fp32),
          method("vulkan condensed deferred fp64", "vulkan", condensed, deferred, fp64),
          method("vulkan cg fp32", "vulkan", cg, Update::automatic, fp32),
          method("vulkan cg fp64", "vulkan", cg, Update::automatic, fp64)}) {
      list.push_back(m);
    }
  }
  return list;
}

Reference::Reference(const Problem& problem, std::span<const Index> removed,
                     std::span<const double> force)
    : ignored(marked(problem, removed)) {
  const Load load = test::load_of(problem, force, {});
  const std::vector<std::uint8_t> destroyed = ignored;
  for (const auto& piece : find_loose_parts(problem, ignored).pieces) {
    for (Index e : piece) ignored[static_cast<std::size_t>(e)] = 1;
  }
  if (pools_volume(problem)) {
    // No method that pools hands out fp32, by which `rounding` would count.
    const auto rest = Yardstick(problem, destroyed).solve(load);
    u = rest.u;
    stress = rest.stress;
    return;
  }
  plain::Body body(problem, destroyed);
  const plain::Solution solution = body.solve(load);
  u = solution.displacement;
  stress = solution.stress;
  std::vector<double> rounded;
  for (double x : u) rounded.push_back(static_cast<double>(static_cast<float>(x)));
  rounding = test::stress_error(ignored, body.stress(rounded), stress);
}

Outcome run_cell(const Method& method, const Problem& problem, std::span<const double> force,
                 std::span<const Index> removed, std::size_t batch, const Reference& reference) {
  Outcome outcome;
  Scene scene = problem.scene();
  scene.solver = method.options;
  const auto own = std::make_shared<Problem>(std::move(scene));
  try {
    Needs needs;
    needs.stress = needs.damage = true;
    const auto created = create_backend(own, needs);
    const Load load = test::load_of(*own, force, {});
    const SolveReport last = run_frames(*created.backend, load, removed, batch, outcome);
    outcome.residual = last.residual;
    outcome.estimate = last.error;
    outcome.iterations = last.iterations;
    compare(*created.backend, *own, reference, outcome);
  } catch (const Error& error) {
    outcome.verdict = "refused";
    outcome.reason = error.what();
    return outcome;
  }
  const bool single = method.options.precision == Precision::fp32;
  if (outcome.stress_error <= method.options.tolerance && std::isfinite(outcome.u_error)) {
    return outcome;
  }
  outcome.verdict = single && outcome.stress_error <= 4 * reference.rounding ? "rounded" : "WRONG";
  return outcome;
}

}  // namespace sunder::bench
