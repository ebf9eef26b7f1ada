// SPDX-License-Identifier: Apache-2.0
#include "solver/storage.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace sunder::solver {
namespace {

// What the mixed recipe holds with fp32 storage (docs/method.md "Stability"); below it only fp64.
constexpr double kFp32Tolerance = 1e-4;
// Past these the displacement handed out in fp32 alone costs a stiff element more than that
// (bench_stability, verdict "rounded").
constexpr double kFp32Contrast = 1e3, kFp32Poisson = 0.4999;

/// What of the materials is past kFp32Contrast and kFp32Poisson; empty: nothing.
std::string past_fp32(const Problem& problem) {
  double softest = problem.small_strain(0).young, stiffest = softest, poisson = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    softest = std::min(softest, problem.small_strain(e).young);
    stiffest = std::max(stiffest, problem.small_strain(e).young);
    poisson = std::max(poisson, problem.small_strain(e).poisson);
  }
  if (stiffest / softest > kFp32Contrast) {
    return "Young's moduli differ by a factor of " + number(stiffest / softest) + ", more than " +
           number(kFp32Contrast);
  }
  if (poisson > kFp32Poisson) {
    std::ostringstream out;
    out << std::setprecision(8) << poisson;
    return "Poisson's ratio is " + out.str() + ", more than " + number(kFp32Poisson);
  }
  return {};
}

}  // namespace

Storage choose_storage(const Problem& problem, bool float64) {
  const SolverOptions& solver = problem.scene().solver;
  const bool eager = solver.update == Update::eager;
  const bool open = solver.precision == Precision::automatic;
  Storage storage;
  storage.fp64 = eager || solver.precision == Precision::fp64 ||
                 (open && !(solver.tolerance >= kFp32Tolerance));
  const std::string past = storage.fp64 ? "" : past_fp32(problem);
  const bool stiff = !past.empty() && open && float64;
  storage.fp64 = storage.fp64 || stiff;
  if (!open) {
    storage.why = storage.fp64 ? "fp64 was asked for" : "fp32 storage was asked for";
    if (!past.empty()) storage.why += ", though these materials need fp64";
  } else if (eager) {
    storage.why = "the update eager needs fp64";
  } else if (stiff) {
    storage.why = "these materials need fp64: contrast over 1000 or Poisson's ratio over 0.4999";
  } else {
    storage.why = "tolerance " + number(solver.tolerance) +
                  (storage.fp64 ? " needs fp64" : " is kept by fp32 storage with fp64 sums");
  }
  if (past.empty() || storage.fp64) return storage;
  storage.warning =
      past + ": displacement handed out in fp32 alone can cost stress more than " +
      number(kFp32Tolerance) + " of its largest value; use " +
      (float64 ? "precision fp64 or auto" : "a device with shaderFloat64 or backend cpu");
  return storage;
}

std::string number(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace sunder::solver
