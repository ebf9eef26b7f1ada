// SPDX-License-Identifier: Apache-2.0
// A Vulkan layer that makes another device of the one at hand: it does what Vulkan lets a driver do
// and lavapipe does not. SUNDER_TEST_LAYER names what, one of
//   backwards  what is recorded between two barriers runs in reverse order
//   families   three families of queues: one that draws, one that copies, one that computes
//   portable   a portable subset of Vulkan alone, which must be asked for by name
// What a program does that such a device would not take is said to SUNDER_TEST_LAYER_LOG, a file
// descriptor: under tests/gpu/validation_watch every word there fails the test.
#pragma once

#include <string>
#include <vector>

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan_core.h>

namespace sunder::layer {

/// What SUNDER_TEST_LAYER says.
[[nodiscard]] const std::string& mode();

/// A program has done what it must not.
void blame(const std::string& what);
/// For a test that looks: to the error output.
void tell(const std::string& what);

struct InstanceNext {
  PFN_vkGetInstanceProcAddr get = nullptr;
  VkInstance handle = VK_NULL_HANDLE;
};
struct DeviceNext {
  PFN_vkGetDeviceProcAddr get = nullptr;
  VkDevice handle = VK_NULL_HANDLE;
};

/// What comes after this layer; `handle`: the instance, the device or what was made of them.
[[nodiscard]] InstanceNext instance_of(const void* handle);
[[nodiscard]] DeviceNext device_of(const void* handle);

template <class Function, class Handle>
Function next_of_instance(Handle handle, const char* name) {
  const InstanceNext next = instance_of(handle);
  return reinterpret_cast<Function>(next.get(next.handle, name));
}
template <class Function, class Handle>
Function next_of_device(Handle handle, const char* name) {
  const DeviceNext next = device_of(handle);
  return reinterpret_cast<Function>(next.get(next.handle, name));
}

template <class Function>
PFN_vkVoidFunction as_void(Function function) {
  return reinterpret_cast<PFN_vkVoidFunction>(function);
}

/// Null: left to the next.
[[nodiscard]] PFN_vkVoidFunction backwards(const char* name);
[[nodiscard]] PFN_vkVoidFunction families(const char* name);
[[nodiscard]] PFN_vkVoidFunction portable(const char* name);

/// What a program asks of vkCreateDevice, to be changed into what the device at hand takes.
struct DeviceWish {
  VkDeviceCreateInfo info{};
  std::vector<const char*> extensions;
  std::vector<VkDeviceQueueCreateInfo> queues;
};
void ask_for_one_family(DeviceWish& wish);
[[nodiscard]] VkResult ask_for_portability(DeviceWish& wish);

}  // namespace sunder::layer
