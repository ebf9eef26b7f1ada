// SPDX-License-Identifier: Apache-2.0
#include "gpu/plan.hpp"

#include <sstream>

#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

// What the mixed recipe holds with fp32 storage (docs/method.md "Stability"); below it only fp64.
constexpr double kFp32Tolerance = 1e-4;

std::string number(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace

Plan make_plan(const Problem& problem, const Needs& needs, const vulkan::PhysicalDevice& device) {
  const SolverOptions& solver = problem.scene().solver;
  if (solver.route != Route::automatic && solver.route != Route::inverse) {
    throw DeviceError("backend vulkan offers the route inverse; choose it, auto or backend cpu");
  }
  Plan plan;
  plan.fp64 = solver.precision == Precision::fp64 ||
              (solver.precision == Precision::automatic && !(solver.tolerance >= kFp32Tolerance));
  plan.eager = solver.update == Update::eager;
  const auto n = static_cast<std::size_t>(problem.dof_count());
  const std::size_t bytes = n * n * (plan.fp64 ? 8 : 4);
  if (bytes > device.memory) {
    throw DeviceError("route inverse needs " + std::to_string(bytes) + " bytes for " +
                      std::to_string(n) + " unknowns, but the device \"" + device.name + "\" has " +
                      std::to_string(device.memory) + "; use backend cpu with route cg");
  }
  plan.why = std::to_string(n) + " unknowns: the dense inverse takes " +
             std::to_string(bytes / 1000000) + " MB; ";
  if (solver.precision != Precision::automatic) {
    plan.why += plan.fp64 ? "fp64 was asked for" : "fp32 storage was asked for";
  } else {
    plan.why += "tolerance " + number(solver.tolerance) +
                (plan.fp64 ? " needs fp64" : " is kept by fp32 storage with fp64 corrections");
  }
  if (needs.damage) {
    plan.why += plan.eager ? "; the eager update was asked for"
                           : "; the deferred update never overwrites the inverse";
  }
  return plan;
}

}  // namespace sunder::gpu
