// SPDX-License-Identifier: Apache-2.0
// A body's places, normals and what it is coloured by in buffers of a host's Vulkan device that its
// simulation is on: for a host in C++, as sunder_vulkan_lend_surface is for one in C.
#pragma once

#include <memory>

#include "sunder/simulation.hpp"
#include "sunder/sunder_vulkan.h"
#include "sunder/surface.hpp"

namespace sunder {

class VulkanSurface {
 public:
  /// Of a simulation by create_backend_on(), which must outlive it, as must its backend and the
  /// buffers. `places`, `normals`: per node, `values`: per triangle, as sunder_vulkan_surface has
  /// them; without a buffer they are not wanted. Null: the backend has no field on a host's device
  /// (laws of finite deformation, motion, cracks that split, or another device).
  [[nodiscard]] static std::unique_ptr<VulkanSurface> on(
      Simulation& simulation, const sunder_vulkan_items& places, const sunder_vulkan_items& normals,
      const sunder_vulkan_items& values = SUNDER_VULKAN_ITEMS_INIT);
  virtual ~VulkanSurface() = default;
  VulkanSurface(const VulkanSurface&) = delete;
  VulkanSurface& operator=(const VulkanSurface&) = delete;

  /// Records what brings the last step's to the buffers, by the rules of
  /// sunder_vulkan_record_surface. `surface`: of the simulation, updated since the last step or
  /// removal. Throws UsageError before the first step, or for a buffer that is too small.
  virtual void record(void* command_buffer, const Surface& surface) = 0;

 protected:
  VulkanSurface() = default;
};

}  // namespace sunder
