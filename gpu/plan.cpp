// SPDX-License-Identifier: Apache-2.0
#include "gpu/plan.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "sunder/error.hpp"
#include "sunder/words.hpp"

namespace sunder::gpu {
namespace {

// What the mixed recipe holds with fp32 storage (docs/method.md "Stability"); below it only fp64.
constexpr double kFp32Tolerance = 1e-4;
// Past these the displacement handed out in fp32 alone costs a stiff element more than that
// (bench_stability, verdict "rounded").
constexpr double kFp32Contrast = 1e3, kFp32Poisson = 0.4999;
// Above this many unknowns an inverse is not computed unless asked for: the host takes n^2 nnz(L).
constexpr Index kDenseLimit = 6000;
// From so many unknowns on a GPU computes the inverse itself: the host's n^2 nnz(L) then takes more
// than a second. Never on a processor that emulates a GPU, where the host is quicker at every size.
constexpr Index kInvertOnDevice = 3000;

std::string megabytes(std::size_t bytes) {
  if (bytes < 10000000) return std::to_string(bytes / 1000) + " kB";
  return std::to_string(bytes / 1000000) + " MB";
}

std::string number(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace

namespace {

struct Extremes {
  double contrast, poisson;  ///< largest over least Young's modulus; the largest ratio
};

Extremes extremes(const Problem& problem) {
  double softest = problem.small_strain(0).young, stiffest = softest, poisson = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    softest = std::min(softest, problem.small_strain(e).young);
    stiffest = std::max(stiffest, problem.small_strain(e).young);
    poisson = std::max(poisson, problem.small_strain(e).poisson);
  }
  return {stiffest / softest, poisson};
}

/// The region of route condensed, where that was asked for or pays by itself.
std::optional<solver::Region> choose_region(const Problem& problem, const Needs& needs,
                                            bool displayed) {
  const SolverOptions& solver = problem.scene().solver;
  const bool asked = solver.route == Route::condensed;
  if (asked && displayed) {
    throw DeviceError(
        "route condensed keeps a region's fields alone on the device, but the host draws those of "
        "the whole body; use route inverse or cg");
  }
  const bool possible =
      solver.route == Route::automatic && solver.update != Update::eager && !displayed;
  if (!asked && !(possible && needs.damage)) return std::nullopt;
  solver::Region region = solver::region_of(problem, needs);
  if (asked) {
    if (!region.elements.empty()) return region;
    throw DeviceError(
        "route condensed needs elements that can break or be destroyed, of which this scene has "
        "none; use route inverse or cg");
  }
  const bool pays = region.tears && solver::kRegionShare * region.dofs.size() <=
                                        static_cast<std::size_t>(problem.dof_count());
  if (!pays || region.dofs.size() > static_cast<std::size_t>(kDenseLimit)) return std::nullopt;
  return region;
}

void choose_route(const Problem& problem, const Needs& needs, const vulkan::PhysicalDevice& device,
                  bool displayed, Plan& plan) {
  const Route asked = problem.scene().solver.route;
  plan.region = choose_region(problem, needs, displayed);
  const auto all = static_cast<std::size_t>(problem.dof_count());
  const std::size_t n = plan.region ? plan.region->dofs.size() : all;
  const std::size_t bytes = n * n * (plan.fp64 ? 8 : 4);
  plan.cg = asked == Route::cg ||
            (asked == Route::automatic && !plan.region && problem.dof_count() > kDenseLimit);
  plan.why = count_of(static_cast<long long>(all), "unknown");
  if (plan.region) {
    plan.why += ", of which " + std::to_string(n) + " can break, are loaded or held by instruments";
  }
  plan.why += ": ";
  if (asked == Route::cg) {
    plan.why += "route cg was asked for";
  } else if (plan.cg) {
    plan.why += "a dense inverse would take " + std::to_string(bytes / 1000000) + " MB";
  } else if (!plan.region && bytes > device.memory) {
    throw DeviceError("route inverse needs " + std::to_string(bytes) + " bytes for " +
                      count_of(static_cast<long long>(n), "unknown") + ", but the device \"" +
                      device.name + "\" has " + std::to_string(device.memory) + "; use route cg");
  } else {
    plan.why +=
        std::string(plan.region ? "their" : "the") + " dense inverse takes " + megabytes(bytes);
  }
}

}  // namespace

namespace {

/// What a device without shaderFloat64 cannot do.
void require_double(const Plan& plan, const SolverOptions& solver,
                    const vulkan::PhysicalDevice& device) {
  const auto refuse = [&](const std::string& what) {
    throw DeviceError(
        what + ", but the device \"" + device.name +
        "\" lacks shaderFloat64; use route inverse or condensed with update deferred and a "
        "tolerance of 1e-4 or more, another device or backend cpu");
  };
  if (plan.eager) refuse("the update eager needs fp64");
  if (plan.fp64) {
    refuse(solver.precision == Precision::fp64
               ? "precision fp64 was asked for"
               : "tolerance " + number(solver.tolerance) + " needs fp64");
  }
  if (plan.cg) refuse("route cg sums in fp64");
}

/// What update eager does not go with.
void check_eager(const SolverOptions& solver) {
  if (solver.update != Update::eager) return;
  if (solver.route == Route::condensed) {
    throw DeviceError(
        "route condensed has the update deferred only; use update deferred or auto, or route "
        "inverse, which update eager writes over");
  }
  if (solver.precision == Precision::fp32) {
    throw DeviceError(
        "update eager has precision fp64 only, since a crack destroys an inverse in fp32 that "
        "events write over (docs/method.md \"Stability\"); use precision fp64 or auto, or update "
        "deferred");
  }
}

/// What of the materials is past kFp32Contrast and kFp32Poisson; empty: nothing.
std::string past_fp32(const Problem& problem) {
  const auto [contrast, poisson] = extremes(problem);
  if (contrast > kFp32Contrast) {
    return "Young's moduli differ by a factor of " + number(contrast) + ", more than " +
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

Plan make_plan(const Problem& problem, const Needs& needs, const vulkan::PhysicalDevice& device,
               bool displayed) {
  const SolverOptions& solver = problem.scene().solver;
  if (solver.route == Route::factor) {
    throw DeviceError(
        "backend vulkan offers the routes inverse, condensed and cg; choose one, auto or "
        "backend cpu");
  }
  check_eager(solver);
  Plan plan;
  plan.eager = solver.update == Update::eager;
  plan.fp64 = plan.eager || solver.precision == Precision::fp64 ||
              (solver.precision == Precision::automatic && !(solver.tolerance >= kFp32Tolerance));
  const std::string past = plan.fp64 ? "" : past_fp32(problem);
  const bool stiff = !past.empty() && solver.precision == Precision::automatic && device.float64;
  plan.fp64 = plan.fp64 || stiff;
  choose_route(problem, needs, device, displayed, plan);
  if (solver.precision != Precision::automatic) {
    plan.why += plan.fp64 ? "; fp64 was asked for" : "; fp32 storage was asked for";
    if (!past.empty()) plan.why += ", though these materials need fp64";
  } else if (plan.eager) {
    plan.why += "; the update eager needs fp64";
  } else if (stiff) {
    plan.why += "; these materials need fp64: contrast over 1000 or Poisson's ratio over 0.4999";
  } else {
    plan.why += "; tolerance " + number(solver.tolerance) +
                (plan.fp64 ? " needs fp64" : " is kept by fp32 storage with fp64 sums");
  }
  if (plan.cg && solver.update != Update::automatic) {
    throw DeviceError("route cg has no inverse to update; use update auto with it");
  }
  if (!past.empty() && !plan.fp64) {
    plan.warnings.push_back(
        past + ": displacement handed out in fp32 alone can cost stress more than " +
        number(kFp32Tolerance) + " of its largest value; use " +
        (device.float64 ? "precision fp64 or auto" : "a device with shaderFloat64 or backend cpu"));
  }
  if (!device.float64) {
    require_double(plan, solver, device);
    plan.why += "; the device lacks shaderFloat64, so the host corrects for the damage";
  }
  const auto kept =
      plan.region ? static_cast<Index>(plan.region->dofs.size()) : problem.dof_count();
  plan.invert_on_device = device.float64 && !plan.cg && !device.is_cpu() && kept >= kInvertOnDevice;
  if (plan.invert_on_device) plan.why += "; the device computes it";
  if (needs.damage && !plan.cg) {
    plan.why += plan.eager ? "; the eager update was asked for"
                           : "; the deferred update never overwrites the inverse";
  }
  return plan;
}

bool host_inverts_anyway(const Problem& problem) {
  const Route asked = problem.scene().solver.route;
  return (asked == Route::automatic || asked == Route::inverse) &&
         problem.dof_count() < kInvertOnDevice;
}

}  // namespace sunder::gpu
