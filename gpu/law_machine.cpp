// SPDX-License-Identifier: Apache-2.0
#include "gpu/law_machine.hpp"

#include <algorithm>

#include "gpu/choose_device.hpp"
#include "gpu/finite_device.hpp"
#include "machine/memory.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

// Unknowns whose inverse a host makes beside the steps in a second (n^3).
constexpr Index kMostDense = 4500;

/// A device and its kernels; what computes on them keeps them.
struct OpenDevice {
  OpenDevice(const VulkanOptions& options, int asked, bool fp64)
      : device(open(options, asked)),
        kernels(*device, options.variant.value_or(choose_variant(device->physical())), fp64) {
    device->set_timing(false);
  }
  static std::unique_ptr<vulkan::Device> open(const VulkanOptions& options, int asked) {
    const auto instance = std::make_shared<vulkan::Instance>(options.instance);
    return vulkan::create_device(instance, choose_device(*instance, asked, options.probe),
                                 options.probe, options.cache);
  }
  std::unique_ptr<vulkan::Device> device;
  KernelFactory kernels;
};

}  // namespace

finite::Machine law_machine(const Problem& problem, const VulkanOptions& options) {
  const std::string whom = problem.moves()    ? "motion"
                           : problem.finite() ? "laws of finite deformation"
                                              : "cracks that split";
  if (options.lent) {
    throw DeviceError("backend vulkan computes " + whom +
                      " on a device of its own, not on a host's; use backend cpu or auto");
  }
  const bool fp64 = problem.scene().solver.precision != Precision::fp32;
  const auto open = std::make_shared<OpenDevice>(options, problem.scene().solver.device, fp64);
  const vulkan::PhysicalDevice& physical = open->device->physical();
  if (!physical.float64) {
    throw DeviceError("the device \"" + physical.name + "\" lacks shaderFloat64, which " + whom +
                      " needs; use another device, or backend cpu or auto");
  }
  finite::Machine machine;
  machine.info.backend = "vulkan";
  machine.info.device = physical.name;
  machine.info.driver = physical.driver;
  machine.info.precision = fp64 ? "fp64" : "fp32";
  machine.memory = machine::available_memory();
  machine.largest_dense = FiniteDevice::most_inverse(open->kernels);
  machine.most_dense = std::min(kMostDense, machine.largest_dense);
  machine.device = [open](const fem::HyperelasticBody& body, Route route, int pairs) {
    const Scene& scene = body.problem.scene();
    const bool viscous = scene.dynamics && scene.dynamics->stiffness_damping > 0;
    const FiniteDevice::Options of_device{route, scene.fracture.stress, pairs, viscous};
    auto made = std::make_unique<FiniteDevice>(open->kernels, body, of_device, open);
    open->device->flush();  // a device that is lost already is known now, not in the first step
    return made;
  };
  return machine;
}

}  // namespace sunder::gpu
