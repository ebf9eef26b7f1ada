// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/choose_route.hpp"

#include <unistd.h>

#include "engine/region.hpp"
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
  if (solver.update == Update::eager && solver.route == Route::factor) {
    throw DeviceError(
        "route factor has the update deferred only; use update deferred or auto, or route inverse "
        "or condensed");
  }
  if (solver.update != Update::automatic && solver.route == Route::cg) {
    throw DeviceError("route cg has no update to choose; use update auto, or route inverse");
  }
}

std::size_t dense_bytes(std::size_t unknowns) { return unknowns * unknowns * sizeof(double); }

void check_memory(Route route, std::size_t unknowns) {
  const std::size_t needed = 2 * dense_bytes(unknowns);  // the inverse, and room to make it
  const std::size_t available = available_memory();
  if (needed > available) {
    throw InputError(InputFault::too_large,
                     "route " + name_of(route) + " needs " + std::to_string(needed) +
                         " bytes for " + std::to_string(unknowns) + " unknowns, but " +
                         std::to_string(available) + " are free; use route factor");
  }
}

std::string megabytes(std::size_t unknowns) {
  const double mb = static_cast<double>(dense_bytes(unknowns)) / 1e6;
  if (mb >= 10) return std::to_string(static_cast<long>(mb)) + " MB";
  return std::to_string(static_cast<long>(1000 * mb)) + " kB";
}

Update update_of(Route route, Update asked) {
  const bool offered = route == Route::inverse || route == Route::condensed;
  return offered && asked == Update::eager ? Update::eager : Update::deferred;
}

}  // namespace

ChosenRoute choose_route(const Problem& problem, const Needs& needs) {
  const SolverOptions& solver = problem.scene().solver;
  check_options(solver);
  const auto all = static_cast<std::size_t>(problem.dof_count());
  if (solver.route != Route::automatic) {
    if (solver.route == Route::inverse) check_memory(Route::inverse, all);
    if (solver.route == Route::condensed) {
      const engine::Region region = engine::region_of(problem, needs);
      check_memory(Route::condensed, region.dofs.size());
      return {Route::condensed, update_of(Route::condensed, solver.update),
              "asked for; " + std::to_string(region.dofs.size()) + " of " + std::to_string(all) +
                  " unknowns can break, are loaded or held by instruments"};
    }
    return {solver.route, update_of(solver.route, solver.update), "asked for"};
  }
  if (solver.update == Update::eager) {
    check_memory(Route::inverse, all);
    return {Route::inverse, Update::eager,
            "update eager was asked for: an inverse has it (route condensed too, when asked for)"};
  }
  const std::string n = std::to_string(problem.dof_count()) + " unknowns";
  if (!needs.damage) {
    return {Route::factor, Update::deferred,
            n + " and nothing can be destroyed: two triangular solves a load"};
  }
  const engine::Region region = engine::region_of(problem, needs);
  const std::size_t inside = region.dofs.size();
  if (region.tears && engine::kRegionShare * inside <= all &&
      inside <= static_cast<std::size_t>(kDenseLimit) &&
      2 * dense_bytes(inside) <= available_memory()) {
    return {Route::condensed, Update::deferred,
            n + ", of which " + std::to_string(inside) +
                " can break, are loaded or held by instruments: their inverse takes " +
                megabytes(inside) + ", and a frame computes nothing else"};
  }
  if (problem.dof_count() <= kDenseLimit && 2 * dense_bytes(all) <= available_memory()) {
    return {Route::inverse, Update::deferred,
            n + ": a dense inverse is small, and a frame reads only its loaded and torn columns"};
  }
  return {Route::factor, Update::deferred,
          n + ": a dense inverse would hold " + std::to_string(dense_bytes(all) / 1000000) +
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
