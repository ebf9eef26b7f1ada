// SPDX-License-Identifier: Apache-2.0
// Fields for a host's renderer: from the solver's buffers into vertex buffers on the device, by one
// dispatch. Nothing is copied and nothing is read back.
#pragma once

#include "gpu/passes/fields.hpp"

namespace sunder::gpu {

/// A host's buffer to write to; without handle the library makes its own.
struct DisplayTarget {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0, bytes = 0;
};

struct DisplayTargets {
  DisplayTarget displacement;  ///< vec4 a node: x, y, z [mm], 0
  DisplayTarget stress;        ///< vec2 an element: yield measure [MPa], ratio to yield
  DisplayTarget live;          ///< uint32 an element: 1, or 0 where destroyed
};

/// At whose multiples a target begins: the largest value that Vulkan allows for
/// minStorageBufferOffsetAlignment.
inline constexpr VkDeviceSize kDisplayAlignment = 256;

struct DisplayBytes {
  std::uint64_t displacement = 0, stress = 0, live = 0;
};
/// What each target must hold.
[[nodiscard]] DisplayBytes display_bytes(const Problem& problem);

/// Timeline semaphores of one submit; without handle there is nothing to wait for or to signal.
struct DisplaySignals {
  VkSemaphore wait = VK_NULL_HANDLE, signal = VK_NULL_HANDLE;
  std::uint64_t wait_value = 0, signal_value = 0;
};

class Display {
 public:
  /// `timeline`: the host enabled timelineSemaphore. Throws DeviceError for a target that is too
  /// small or not aligned.
  Display(const KernelFactory& kernels, const Problem& problem, const Fields& fields,
          bool has_stress, const DisplayTargets& targets, bool timeline);
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  /// Into a host's command buffer, outside a render pass. Waits for earlier reads of the targets;
  /// later commands of the queue see what it writes. Leaves a compute pipeline, descriptor set 0
  /// and push constants bound.
  void record(VkCommandBuffer commands) const;
  /// On the queue, at once; finish() waits for it. Throws DeviceError for a semaphore on a device
  /// whose host did not enable timelineSemaphore.
  void submit(const DisplaySignals& signals);
  /// Until the last submit() is done.
  void finish();

  [[nodiscard]] const vulkan::Buffer& displacement() const { return displacement_; }
  [[nodiscard]] const vulkan::Buffer& stress() const { return stress_; }
  [[nodiscard]] const vulkan::Buffer& live() const { return live_; }
  [[nodiscard]] std::uint32_t nodes() const { return push_.nodes; }
  [[nodiscard]] std::uint32_t elements() const { return push_.elements; }

 private:
  [[nodiscard]] vulkan::Buffer target(const DisplayTarget& given, std::size_t bytes,
                                      const char* what) const;
  void create_own_commands();

  vulkan::Device& device_;
  shaders::DisplayPush push_;
  bool timeline_;
  vulkan::Buffer displacement_, stress_, live_;
  std::unique_ptr<vulkan::Kernel> kernel_;
  std::unique_ptr<vulkan::Binding> binding_;
  VkCommandBuffer own_ = VK_NULL_HANDLE;
  VkFence done_ = VK_NULL_HANDLE;
  bool pending_ = false;
};

}  // namespace sunder::gpu
