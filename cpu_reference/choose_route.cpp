// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/choose_route.hpp"

#include <unistd.h>

#include "sunder/error.hpp"

namespace sunder::cpu_reference {
namespace {

// Above this many unknowns a dense inverse (8 n^2 bytes) is not chosen by itself: 288 MB and
// seconds to prepare, while the factor's frame is still within a millisecond of it.
constexpr Index kDenseLimit = 6000;

void check_options(const SolverOptions& solver) {
  if (solver.precision == Precision::fp32) {
    throw DeviceError("backend cpu computes in fp64 only; use precision fp64 or auto");
  }
  if (solver.device > 0) {
    throw DeviceError("backend cpu has device 0 only, not " + std::to_string(solver.device));
  }
  if (solver.route == Route::condensed) {
    throw DeviceError(
        "backend cpu offers the routes inverse, factor and cg; choose one of them or auto");
  }
  if (solver.update == Update::eager && solver.route == Route::factor) {
    throw DeviceError(
        "route factor has the update deferred only; use update deferred or auto, or route inverse");
  }
  if (solver.update != Update::automatic && solver.route == Route::cg) {
    throw DeviceError("route cg has no update to choose; use update auto, or route inverse");
  }
}

std::size_t dense_bytes(const Problem& problem) {
  const auto n = static_cast<std::size_t>(problem.dof_count());
  return n * n * sizeof(double);
}

void check_memory(const Problem& problem) {
  const std::size_t needed = 2 * dense_bytes(problem);  // the inverse, and room to make it
  const std::size_t available = available_memory();
  if (needed > available) {
    throw InputError(InputFault::too_large,
                     "route inverse needs " + std::to_string(needed) + " bytes for " +
                         std::to_string(problem.dof_count()) + " unknowns, but " +
                         std::to_string(available) + " are free; use route factor");
  }
}

Update update_of(Route route, Update asked) {
  return route == Route::inverse && asked == Update::eager ? Update::eager : Update::deferred;
}

}  // namespace

ChosenRoute choose_route(const Problem& problem, const Needs& needs) {
  const SolverOptions& solver = problem.scene().solver;
  check_options(solver);
  if (solver.route != Route::automatic) {
    if (solver.route == Route::inverse) check_memory(problem);
    return {solver.route, update_of(solver.route, solver.update), "asked for"};
  }
  if (solver.update == Update::eager) {
    check_memory(problem);
    return {Route::inverse, Update::eager, "update eager was asked for: only an inverse has it"};
  }
  const std::string n = std::to_string(problem.dof_count()) + " unknowns";
  if (!needs.damage) {
    return {Route::factor, Update::deferred,
            n + " and nothing can be destroyed: two triangular solves a load"};
  }
  if (problem.dof_count() <= kDenseLimit && 2 * dense_bytes(problem) <= available_memory()) {
    return {Route::inverse, Update::deferred,
            n + ": a dense inverse is small, and a frame reads only its loaded and torn columns"};
  }
  return {Route::factor, Update::deferred,
          n + ": a dense inverse would hold " + std::to_string(dense_bytes(problem) / 1000000) +
              " MB; a fracture updates the factor along its elimination path only"};
}

std::string name_of(Route route) {
  switch (route) {
    case Route::inverse:
      return "inverse";
    case Route::condensed:
      return "condensed";
    case Route::factor:
      return "factor";
    case Route::cg:
      return "cg";
    case Route::automatic:
      break;
  }
  return "auto";
}

std::string name_of_update(const ChosenRoute& chosen) {
  if (chosen.route == Route::cg) return "matrix";
  return chosen.update == Update::eager ? "eager" : "deferred";
}

std::size_t available_memory() {
  return static_cast<std::size_t>(sysconf(_SC_AVPHYS_PAGES)) *
         static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace sunder::cpu_reference
