// SPDX-License-Identifier: Apache-2.0
// What ends a command buffer: a barrier that lets the host and all that comes later see what was
// written. No layer misses it, and on lavapipe nothing goes wrong without it.
#include <cstring>
#include <vector>

#include "gpu/vulkan/commands.hpp"
#include "gpu/vulkan/lent_device.hpp"
#include "gpu_body.hpp"
#include "machine/shared_library.hpp"

namespace sunder::test {
namespace {

/// The last barrier of the command buffer that was ended last.
struct Barrier {
  VkPipelineStageFlags from_stages = 0, to_stages = 0;
  VkAccessFlags from = 0, to = 0;
};
struct Seen {
  bool barrier_came_last = false, at_the_end = false;
  Barrier last;
};
Seen seen;

PFN_vkGetInstanceProcAddr real_get = nullptr;
PFN_vkGetDeviceProcAddr real_device_get = nullptr;
PFN_vkCmdPipelineBarrier real_barrier = nullptr;
PFN_vkCmdFillBuffer real_fill = nullptr;
PFN_vkEndCommandBuffer real_end = nullptr;

VKAPI_ATTR void VKAPI_CALL see_barrier(VkCommandBuffer commands, VkPipelineStageFlags from_stages,
                                       VkPipelineStageFlags to_stages, VkDependencyFlags flags,
                                       std::uint32_t count, const VkMemoryBarrier* barriers,
                                       std::uint32_t, const VkBufferMemoryBarrier*, std::uint32_t,
                                       const VkImageMemoryBarrier*) {
  ASSERT_EQ(count, 1u);
  seen.last = {from_stages, to_stages, barriers->srcAccessMask, barriers->dstAccessMask};
  seen.barrier_came_last = true;
  real_barrier(commands, from_stages, to_stages, flags, count, barriers, 0, nullptr, 0, nullptr);
}
VKAPI_ATTR void VKAPI_CALL see_fill(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                                    VkDeviceSize bytes, std::uint32_t value) {
  seen.barrier_came_last = false;
  real_fill(commands, buffer, offset, bytes, value);
}
VKAPI_ATTR VkResult VKAPI_CALL see_end(VkCommandBuffer commands) {
  seen.at_the_end = seen.barrier_came_last;
  return real_end(commands);
}

template <class Function>
PFN_vkVoidFunction between(Function& real, PFN_vkVoidFunction found, Function ours) {
  real = reinterpret_cast<Function>(found);
  return reinterpret_cast<PFN_vkVoidFunction>(ours);
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_of_device(VkDevice device, const char* name) {
  const PFN_vkVoidFunction found = real_device_get(device, name);
  if (!std::strcmp(name, "vkCmdPipelineBarrier")) return between(real_barrier, found, see_barrier);
  if (!std::strcmp(name, "vkCmdFillBuffer")) return between(real_fill, found, see_fill);
  if (!std::strcmp(name, "vkEndCommandBuffer")) return between(real_end, found, see_end);
  return found;
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_of_instance(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction found = real_get(instance, name);
  if (std::strcmp(name, "vkGetDeviceProcAddr") != 0) return found;
  return between(real_device_get, found, get_of_device);
}

/// A device of ours lent to ourselves, with someone who looks on in between.
struct LookedOn {
  explicit LookedOn(const vulkan::DeviceProbe& probe = {})
      : library(options.loader),
        instance(std::make_shared<vulkan::Instance>(options)),
        own(watched_device(instance, {})) {
    real_get =
        library.function<std::remove_pointer_t<PFN_vkGetInstanceProcAddr>>("vkGetInstanceProcAddr");
    vulkan::LentDevice lent;
    lent.get = get_of_instance;
    lent.instance = instance->handle();
    lent.physical = own->physical().handle;
    lent.device = own->handle();
    lent.family = static_cast<std::uint32_t>(own->physical().compute_family);
    own->vk().GetDeviceQueue(lent.device, lent.family, 0, &lent.queue);
    lent.api_version = VK_API_VERSION_1_2;
    device = vulkan::borrow_device(lent, probe);
  }

  vulkan::InstanceOptions options;
  machine::SharedLibrary library;
  std::shared_ptr<vulkan::Instance> instance;
  std::unique_ptr<vulkan::Device> own, device;
};

using HostBarrier = WithVulkan<>;

TEST_F(HostBarrier, EndsEveryCommandBuffer) {
  LookedOn looked;
  const vulkan::Buffer buffer(*looked.device, 256, vulkan::Placement::device);
  vulkan::Commands commands(*looked.device);
  seen = {};
  commands.begin();
  commands.fill_zero(buffer, 0, 256);
  commands.end();
  commands.submit();
  EXPECT_TRUE(seen.at_the_end);
  constexpr VkPipelineStageFlags stages =
      VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  constexpr VkAccessFlags written = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  EXPECT_EQ(seen.last.from_stages & stages, stages);
  EXPECT_EQ(seen.last.from & written, written);
  EXPECT_NE(seen.last.to_stages & VK_PIPELINE_STAGE_HOST_BIT, 0u);
  EXPECT_NE(seen.last.to & VK_ACCESS_HOST_READ_BIT, 0u);
  // Whatever comes later, of this submit or another.
  constexpr VkAccessFlags any = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
  EXPECT_NE(seen.last.to_stages & VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0u);
  EXPECT_EQ(seen.last.to & any, any);
}

using LentAllocations = WithVulkan<>;

// Who borrows a device shares its allocations with its owner.
TEST_F(LentAllocations, AreCountedWithTheOwners) {
  vulkan::DeviceProbe probe;
  probe.limits.allocations = 3;
  const LookedOn looked(probe);
  const auto buffer = [](vulkan::Device& device) {
    return vulkan::Buffer(device, 64, vulkan::Placement::device);
  };
  const vulkan::Buffer first = buffer(*looked.own), second = buffer(*looked.own),
                       third = buffer(*looked.device);
  EXPECT_THROW(static_cast<void>(buffer(*looked.device)), DeviceError);
}

}  // namespace
}  // namespace sunder::test
