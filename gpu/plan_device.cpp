// SPDX-License-Identifier: Apache-2.0
#include "gpu/plan_device.hpp"

#include "gpu/device_rates.hpp"

namespace sunder::gpu {
namespace {

// From so many unknowns on a GPU computes the inverse itself: the host's n^2 nnz(L) then takes more
// than a second. Never on a processor that emulates a GPU, where the host is quicker at every size.
constexpr Index kInvertOnDevice = 3000;

// Of the rate at which a kernel reads what lies side by side, what those of a frame reach, which
// gather (lavapipe).
constexpr double kOfStreaming = .7;

/// Nominal, of a kind of device.
solver::FrameRates nominal(VkPhysicalDeviceType type) {
  solver::FrameRates rates{.frame = 0, .event = 60e-6, .submit = 20e-6};
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_CPU:  // lavapipe on two cores
      rates.stress = 10e-9, rates.bytes = 8e9, rates.dispatch = 15e-6, rates.flops = 15e9;
      break;
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      rates.stress = .05e-9, rates.bytes = 400e9, rates.dispatch = 5e-6, rates.flops = 300e9;
      break;
    default:
      rates.stress = .5e-9, rates.bytes = 40e9, rates.dispatch = 5e-6, rates.flops = 30e9;
  }
  return rates;
}

void set_throughput(double bytes, double flops, solver::FrameRates& rates) {
  rates.bytes = kOfStreaming * bytes;
  rates.flops = flops;
  rates.stress = solver::kStressFlops / flops;
}

/// As measured once, else of its kind.
solver::FrameRates rates_of(const vulkan::PhysicalDevice& device) {
  solver::FrameRates rates = nominal(device.type);
  const auto kept = kept_rates(device);
  if (!kept) return rates;
  rates.submit = kept->submit;
  rates.dispatch = kept->dispatch;
  set_throughput(kept->bytes, kept->flops, rates);
  rates.measured = true;
  return rates;
}

}  // namespace

solver::PlanDevice plan_device(const vulkan::PhysicalDevice& device, bool displayed) {
  solver::PlanDevice plan;
  plan.backend = "vulkan";
  plan.name = device.name;
  plan.routes = {Route::inverse, Route::condensed, Route::cg};
  plan.memory = device.memory;
  plan.fp32 = true;
  plan.fp64 = device.float64;
  plan.displayed = displayed;
  if (!device.is_cpu()) plan.inverts_from = kInvertOnDevice;
  plan.rates = rates_of(device);
  return plan;
}

solver::FrameRates rates_of_a_gpu(double bytes, double flops) {
  solver::FrameRates rates = nominal(VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU);
  set_throughput(bytes, flops, rates);
  return rates;
}

bool host_inverts_anyway(const Problem& problem) {
  const Route asked = problem.scene().solver.route;
  return (asked == Route::automatic || asked == Route::inverse) &&
         problem.dof_count() < kInvertOnDevice;
}

}  // namespace sunder::gpu
