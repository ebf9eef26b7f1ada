// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/choose_route.hpp"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <utility>

#include "solver/region.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"

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
  if (solver.update == Update::eager &&
      (solver.route == Route::factor || solver.route == Route::condensed)) {
    throw DeviceError("route " + name_of(solver.route) +
                      " has the update deferred only; use update deferred or auto, or route "
                      "inverse, which update eager writes over");
  }
  if (solver.update != Update::automatic && solver.route == Route::cg) {
    throw DeviceError("route cg has no update to choose; use update auto, or route inverse");
  }
}

std::size_t dense_bytes(std::size_t unknowns) { return unknowns * unknowns * sizeof(double); }

/// The inverse, and room to make it.
std::size_t inverse_bytes(std::size_t unknowns) { return 2 * dense_bytes(unknowns); }

/// The factor, and what exists beside it in a long tear: that of a damaged body while a newer one
/// is made. The stiffness: in the factor's order, and once more on the way there.
std::size_t factor_bytes(const fem::Analysis& analysis, const Needs& needs) {
  const std::size_t factors = needs.damage ? 3 : 1;
  return factors * analysis.entries() * sizeof(double) +
         2 * static_cast<std::size_t>(analysis.ordered.nonZeros()) *
             (sizeof(double) + sizeof(Index));
}

// Bytes of an element while its stiffness goes into the matrix: 78 entries in a list with row and
// column, and again in the matrix before equal ones are summed.
constexpr std::size_t kAssembly = 78 * (16 + 12);
// And then of all else that a frame holds: shapes, stress, the matrix and its incomplete factor.
constexpr std::size_t kElement = 800;

std::size_t incomplete_bytes(const Problem& problem) {
  return static_cast<std::size_t>(problem.tet_count()) * (kAssembly + kElement);
}

std::string unknowns_of(const Problem& problem) { return count_of(problem.dof_count(), "unknown"); }

[[noreturn]] void refuse(const std::string& what, std::size_t needed, const Problem& problem,
                         std::size_t memory, const std::string& instead) {
  throw InputError(InputFault::too_large, what + " needs " + std::to_string(needed) +
                                              " bytes for " + unknowns_of(problem) + ", but " +
                                              std::to_string(memory) + " are free; " + instead);
}

/// What a dense inverse asked for would take by itself.
void check_dense(const Problem& problem, const Needs& needs, std::size_t memory) {
  const SolverOptions& solver = problem.scene().solver;
  const bool condensed = solver.route == Route::condensed;
  const bool inverse = solver.route == Route::inverse ||
                       (solver.route == Route::automatic && solver.update == Update::eager);
  if (!condensed && !inverse) return;
  const std::size_t n = condensed ? solver::region_of(problem, needs).dofs.size()
                                  : static_cast<std::size_t>(problem.dof_count());
  const std::size_t needed = inverse_bytes(n);
  if (needed <= memory) return;
  refuse("route " + name_of(condensed ? Route::condensed : Route::inverse), needed, problem, memory,
         "use route factor");
}

std::string megabytes(std::size_t unknowns) {
  const double mb = static_cast<double>(dense_bytes(unknowns)) / 1e6;
  if (mb >= 10) return std::to_string(static_cast<long>(mb)) + " MB";
  return std::to_string(static_cast<long>(1000 * mb)) + " kB";
}

Update update_of(Route route, Update asked) {
  return route == Route::inverse && asked == Update::eager ? Update::eager : Update::deferred;
}

/// Unknowns with a force that an instrument brings, at most.
std::size_t loaded_unknowns(const Problem& problem) {
  std::size_t loaded = 0;
  for (const InstrumentNodes& i : problem.instrument_nodes()) {
    loaded += 3 * std::max<std::size_t>(i.nodes.size(), 2);  // 2: a press
  }
  return std::min(loaded, static_cast<std::size_t>(problem.dof_count()));
}

/// Where the factor fits the memory; `left`: what it leaves.
ChosenRoute choose_by_size(const Problem& problem, const Needs& needs, std::size_t entries,
                           std::size_t left) {
  const std::string n = unknowns_of(problem);
  const auto all = static_cast<std::size_t>(problem.dof_count());
  if (!needs.damage) {
    return {Route::factor, Update::deferred,
            n + " and nothing can be destroyed: two triangular solves a load", nullptr};
  }
  const solver::Region region = solver::region_of(problem, needs);
  const std::size_t inside = region.dofs.size();
  if (region.tears && solver::kRegionShare * inside <= all &&
      inside <= static_cast<std::size_t>(kDenseLimit) && inverse_bytes(inside) <= left) {
    return {Route::condensed, Update::deferred,
            n + ", of which " + std::to_string(inside) +
                " can break, are loaded or held by instruments: their inverse takes " +
                megabytes(inside) + ", and a frame computes nothing else",
            nullptr};
  }
  const std::size_t loaded = loaded_unknowns(problem);
  if (loaded * all > 2 * entries) {  // as core/solver/inverse_base.cpp
    return {Route::factor, Update::deferred,
            n + ", " + std::to_string(loaded) +
                " of them loaded: so many columns of an inverse are more to read than two "
                "triangular solves",
            nullptr};
  }
  if (problem.dof_count() <= kDenseLimit && inverse_bytes(all) <= left) {
    return {Route::inverse, Update::deferred,
            n + ": a dense inverse is small, and a frame reads only its loaded and torn columns",
            nullptr};
  }
  return {Route::factor, Update::deferred,
          n + ": a dense inverse would hold " + std::to_string(dense_bytes(all) / 1000000) +
              " MB; a fracture updates the factor along its elimination path only",
          nullptr};
}

ChosenRoute asked_for(const Problem& problem, const Needs& needs) {
  const SolverOptions& solver = problem.scene().solver;
  if (solver.route == Route::automatic) {
    return {Route::inverse, Update::eager,
            "update eager was asked for, which route inverse alone has", nullptr};
  }
  std::string why = "asked for";
  if (solver.route == Route::condensed) {
    why += "; " + std::to_string(solver::region_of(problem, needs).dofs.size()) + " of " +
           count_of(problem.dof_count(), "unknown") +
           " can break, are loaded or held by instruments";
  }
  return {solver.route, update_of(solver.route, solver.update), std::move(why), nullptr};
}

/// Where the factor, which every other route is made by, does not fit the memory.
ChosenRoute without_factor(const Problem& problem, std::size_t needed, std::size_t memory) {
  const SolverOptions& solver = problem.scene().solver;
  const bool possible = (solver.route == Route::automatic && solver.update != Update::eager) ||
                        solver.route == Route::cg;
  if (!possible) {
    const Route route = solver.route == Route::automatic ? Route::inverse : solver.route;
    refuse("the factor of route " + name_of(route), needed, problem, memory, "use route cg");
  }
  const std::string why = unknowns_of(problem) + ": their factor needs " + std::to_string(needed) +
                          " bytes, but " + std::to_string(memory) +
                          " are free; an incomplete one preconditions conjugate gradients";
  return {Route::cg, Update::deferred, solver.route == Route::cg ? "asked for; " + why : why,
          nullptr};
}

}  // namespace

ChosenRoute choose_route(const Problem& problem, const Needs& needs, std::size_t memory) {
  check_options(problem.scene().solver);
  check_dense(problem, needs, memory);
  if (const std::size_t least = incomplete_bytes(problem); least > memory) {
    refuse("even route cg", least, problem, memory, "use a coarser mesh or a larger machine");
  }
  std::unique_ptr<const fem::Analysis> analysis = fem::analyse(problem);
  const std::size_t needed = factor_bytes(*analysis, needs);
  if (needed > memory) return without_factor(problem, needed, memory);
  const SolverOptions& solver = problem.scene().solver;
  const bool asked = solver.route != Route::automatic || solver.update == Update::eager;
  ChosenRoute chosen = asked ? asked_for(problem, needs)
                             : choose_by_size(problem, needs, analysis->entries(), memory - needed);
  chosen.analysis = std::move(analysis);
  return chosen;
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

namespace {

/// "MemAvailable:  1234 kB" of a file: its number; none: the file has no such line.
std::optional<std::size_t> number_of(const char* file, const std::string& name) {
  std::ifstream in(file);
  std::string word;
  std::size_t value = 0;
  while (in >> word) {
    if (word == name && in >> value) return value;
  }
  return std::nullopt;
}

/// The one number in a file; none: it is not there, or is "max".
std::optional<std::size_t> number_in(const char* file) {
  std::ifstream in(file);
  std::size_t value = 0;
  if (in >> value) return value;
  return std::nullopt;
}

}  // namespace

std::size_t available_memory() {
  std::size_t bytes = static_cast<std::size_t>(sysconf(_SC_AVPHYS_PAGES)) *
                      static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  if (const auto kilobytes = number_of("/proc/meminfo", "MemAvailable:")) bytes = *kilobytes * 1024;
  // Of a container (control groups, version 2). What of its use caches files can be had too.
  const auto limit = number_in("/sys/fs/cgroup/memory.max");
  const auto used = number_in("/sys/fs/cgroup/memory.current");
  if (!limit || !used) return bytes;
  const std::size_t cached = number_of("/sys/fs/cgroup/memory.stat", "inactive_file").value_or(0);
  const std::size_t held = *used - std::min(*used, cached);
  return std::min(bytes, *limit - std::min(*limit, held));
}

}  // namespace sunder::cpu_reference
