// SPDX-License-Identifier: Apache-2.0
// A watched device with kernels of one variant, and inverses computed there.
#pragma once

#include <numeric>

#include "gpu/passes/block_inversion.hpp"
#include "gpu_body.hpp"

namespace sunder::test {

struct OnDevice {
  /// `memory`: that the device says that it has; 0: what it has.
  OnDevice(gpu::Variant variant, bool fp64, VkDeviceSize memory = 0) {
    vulkan::InstanceOptions options;
    options.validation = validated();
    options.messages = messages;
    const auto instance = std::make_shared<vulkan::Instance>(options);
    vulkan::DeviceProbe probe = watched_probe();
    if (memory > 0) probe.memory = memory;
    device = watched_device(instance, probe);
    factory = std::make_unique<gpu::KernelFactory>(*device, variant, fp64);
  }
  ~OnDevice() {
    factory.reset();
    device.reset();
    for (const std::string& m : messages->texts) ADD_FAILURE() << m;
  }
  OnDevice(const OnDevice&) = delete;
  OnDevice& operator=(const OnDevice&) = delete;
  Eigen::MatrixXd invert(const linear_algebra::SparseMatrix& lower, std::size_t panel_bytes) {
    const auto n = static_cast<Index>(lower.rows());
    const auto rows = gpu::round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
    gpu::DenseInverse inverse(*factory, n, rows, panel_bytes);
    gpu::invert_on_device(*factory, lower, rows, panel_bytes, inverse);
    std::vector<Index> all(static_cast<std::size_t>(n));
    std::iota(all.begin(), all.end(), 0);
    return inverse.pick(all, all);
  }
  std::shared_ptr<vulkan::Messages> messages = std::make_shared<vulkan::Messages>();
  std::unique_ptr<vulkan::Device> device;
  std::unique_ptr<gpu::KernelFactory> factory;
};

}  // namespace sunder::test
