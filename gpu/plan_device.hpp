// SPDX-License-Identifier: Apache-2.0
// A Vulkan device as plans (core/solver/plan.hpp) see it.
#pragma once

#include "gpu/vulkan/physical_device.hpp"
#include "solver/plan.hpp"

namespace sunder::gpu {

/// `displayed`: a host draws the whole body's fields, which must be on the device then.
[[nodiscard]] solver::PlanDevice plan_device(const vulkan::PhysicalDevice& device, bool displayed);

/// Of a discrete GPU that moves so many bytes and does so many flops in fp64 a second; the rest is
/// nominal.
[[nodiscard]] solver::FrameRates rates_of_a_gpu(double bytes, double flops);

/// Whatever the device, the host computes this problem's inverse: it may begin before there is one.
[[nodiscard]] bool host_inverts_anyway(const Problem& problem);

}  // namespace sunder::gpu
