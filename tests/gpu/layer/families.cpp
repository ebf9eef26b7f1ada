// SPDX-License-Identifier: Apache-2.0
// Three families of queues of the one that is there. Kept account of: the family of each command
// buffer, and of each buffer the families that may touch it. A buffer of exclusive sharing belongs
// to the family that touches it first, until it is released and acquired.
#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "layer.hpp"

namespace sunder::layer {
namespace {

constexpr std::uint32_t kReal = 0;  // lavapipe's only one
constexpr std::array<VkQueueFlags, 3> kKinds{VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_TRANSFER_BIT,
                                             VK_QUEUE_TRANSFER_BIT,
                                             VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT};
constexpr std::uint32_t kNone = VK_QUEUE_FAMILY_IGNORED;

struct Sharing {
  std::set<std::uint32_t> families;  // of concurrent sharing
  std::uint32_t owner = kNone;       // of exclusive
};

std::mutex mutex;
std::set<std::uint32_t> asked;
std::map<VkCommandPool, std::uint32_t> pools;
std::map<VkCommandBuffer, std::uint32_t> commands_of;
std::map<VkBuffer, Sharing> buffers;
std::map<VkBufferView, VkBuffer> views;
std::map<VkDescriptorSet, std::map<std::uint32_t, VkBuffer>> sets_of;

std::string named(std::uint32_t family) { return "queue family " + std::to_string(family); }

std::uint32_t family_of(VkCommandBuffer commands) {
  const auto found = commands_of.find(commands);
  return found == commands_of.end() ? kNone : found->second;
}

/// Of the mutex's holder.
void touch(VkBuffer buffer, std::uint32_t family) {
  const auto found = buffers.find(buffer);
  if (found == buffers.end()) return;
  Sharing& sharing = found->second;
  if (!sharing.families.empty()) {
    if (!sharing.families.contains(family))
      blame("a buffer that others share is used by " + named(family));
    return;
  }
  if (sharing.owner == kNone) sharing.owner = family;
  if (sharing.owner != family) {
    blame("a buffer of " + named(sharing.owner) + " is used by " + named(family));
  }
}

void list_families(std::uint32_t* count, const VkQueueFamilyProperties& real,
                   VkQueueFamilyProperties* list) {
  if (!list) {
    *count = kKinds.size();
    return;
  }
  *count = std::min<std::uint32_t>(*count, kKinds.size());
  for (std::uint32_t f = 0; f < *count; ++f) {
    list[f] = real;
    list[f].queueFlags = kKinds[f];
    list[f].queueCount = 1;
  }
}

VKAPI_ATTR void VKAPI_CALL get_families(VkPhysicalDevice physical, std::uint32_t* count,
                                        VkQueueFamilyProperties* list) {
  std::uint32_t there = 1;
  VkQueueFamilyProperties real{};
  next_of_instance<PFN_vkGetPhysicalDeviceQueueFamilyProperties>(
      physical, "vkGetPhysicalDeviceQueueFamilyProperties")(physical, &there, &real);
  list_families(count, real, list);
}

VKAPI_ATTR void VKAPI_CALL get_queue(VkDevice device, std::uint32_t family, std::uint32_t index,
                                     VkQueue* queue) {
  {
    const std::lock_guard lock(mutex);
    if (!asked.contains(family)) blame("a queue of " + named(family) + ", not asked for");
  }
  next_of_device<PFN_vkGetDeviceQueue>(device, "vkGetDeviceQueue")(device, kReal, index, queue);
}

VKAPI_ATTR VkResult VKAPI_CALL create_pool(VkDevice device, const VkCommandPoolCreateInfo* info,
                                           const VkAllocationCallbacks* allocator,
                                           VkCommandPool* pool) {
  VkCommandPoolCreateInfo real = *info;
  real.queueFamilyIndex = kReal;
  const VkResult result = next_of_device<PFN_vkCreateCommandPool>(device, "vkCreateCommandPool")(
      device, &real, allocator, pool);
  const std::lock_guard lock(mutex);
  if (!asked.contains(info->queueFamilyIndex)) {
    blame("a command pool of " + named(info->queueFamilyIndex) + ", not asked for");
  }
  if (result == VK_SUCCESS) pools[*pool] = info->queueFamilyIndex;
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL allocate_commands(VkDevice device,
                                                 const VkCommandBufferAllocateInfo* info,
                                                 VkCommandBuffer* list) {
  const VkResult result = next_of_device<PFN_vkAllocateCommandBuffers>(
      device, "vkAllocateCommandBuffers")(device, info, list);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(mutex);
  for (std::uint32_t i = 0; i < info->commandBufferCount; ++i) {
    commands_of[list[i]] = pools[info->commandPool];
  }
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL create_buffer(VkDevice device, const VkBufferCreateInfo* info,
                                             const VkAllocationCallbacks* allocator,
                                             VkBuffer* buffer) {
  VkBufferCreateInfo real = *info;
  real.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  real.queueFamilyIndexCount = 0;
  real.pQueueFamilyIndices = nullptr;
  const VkResult result = next_of_device<PFN_vkCreateBuffer>(device, "vkCreateBuffer")(
      device, &real, allocator, buffer);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(mutex);
  Sharing& sharing = buffers[*buffer] = {};
  if (info->sharingMode == VK_SHARING_MODE_CONCURRENT) {
    sharing.families.insert(info->pQueueFamilyIndices,
                            info->pQueueFamilyIndices + info->queueFamilyIndexCount);
  }
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL create_view(VkDevice device, const VkBufferViewCreateInfo* info,
                                           const VkAllocationCallbacks* allocator,
                                           VkBufferView* view) {
  const VkResult result = next_of_device<PFN_vkCreateBufferView>(device, "vkCreateBufferView")(
      device, info, allocator, view);
  const std::lock_guard lock(mutex);
  if (result == VK_SUCCESS) views[*view] = info->buffer;
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL allocate_sets(VkDevice device,
                                             const VkDescriptorSetAllocateInfo* info,
                                             VkDescriptorSet* list) {
  const VkResult result = next_of_device<PFN_vkAllocateDescriptorSets>(
      device, "vkAllocateDescriptorSets")(device, info, list);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(mutex);
  for (std::uint32_t i = 0; i < info->descriptorSetCount; ++i) sets_of[list[i]].clear();
  return result;
}

VKAPI_ATTR void VKAPI_CALL update_sets(VkDevice device, std::uint32_t count,
                                       const VkWriteDescriptorSet* writes, std::uint32_t copies,
                                       const VkCopyDescriptorSet* copy) {
  next_of_device<PFN_vkUpdateDescriptorSets>(device, "vkUpdateDescriptorSets")(
      device, count, writes, copies, copy);
  const std::lock_guard lock(mutex);
  for (std::uint32_t w = 0; w < count; ++w) {
    const VkWriteDescriptorSet& write = writes[w];
    for (std::uint32_t d = 0; d < write.descriptorCount; ++d) {
      VkBuffer& bound = sets_of[write.dstSet][write.dstBinding + d];
      if (write.pBufferInfo) bound = write.pBufferInfo[d].buffer;
      if (write.pTexelBufferView) bound = views[write.pTexelBufferView[d]];
    }
  }
}

VKAPI_ATTR void VKAPI_CALL bind_sets(VkCommandBuffer commands, VkPipelineBindPoint point,
                                     VkPipelineLayout layout, std::uint32_t first,
                                     std::uint32_t count, const VkDescriptorSet* sets,
                                     std::uint32_t offsets, const std::uint32_t* dynamic) {
  {
    const std::lock_guard lock(mutex);
    const std::uint32_t family = family_of(commands);
    if (point == VK_PIPELINE_BIND_POINT_COMPUTE && family < kKinds.size() &&
        !(kKinds[family] & VK_QUEUE_COMPUTE_BIT)) {
      blame(named(family) + " is to compute");
    }
    for (std::uint32_t s = 0; s < count; ++s) {
      for (const auto& [binding, buffer] : sets_of[sets[s]]) touch(buffer, family);
    }
  }
  next_of_device<PFN_vkCmdBindDescriptorSets>(commands, "vkCmdBindDescriptorSets")(
      commands, point, layout, first, count, sets, offsets, dynamic);
}

VKAPI_ATTR void VKAPI_CALL copy(VkCommandBuffer commands, VkBuffer from, VkBuffer to,
                                std::uint32_t count, const VkBufferCopy* regions) {
  {
    const std::lock_guard lock(mutex);
    for (const VkBuffer buffer : {from, to}) touch(buffer, family_of(commands));
  }
  next_of_device<PFN_vkCmdCopyBuffer>(commands, "vkCmdCopyBuffer")(commands, from, to, count,
                                                                   regions);
}
VKAPI_ATTR void VKAPI_CALL fill(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                                VkDeviceSize bytes, std::uint32_t value) {
  {
    const std::lock_guard lock(mutex);
    touch(buffer, family_of(commands));
  }
  next_of_device<PFN_vkCmdFillBuffer>(commands, "vkCmdFillBuffer")(commands, buffer, offset, bytes,
                                                                   value);
}

/// A release hands the buffer over, and an acquire takes what was handed over.
VKAPI_ATTR void VKAPI_CALL barrier(VkCommandBuffer commands, VkPipelineStageFlags from,
                                   VkPipelineStageFlags to, VkDependencyFlags flags,
                                   std::uint32_t memories, const VkMemoryBarrier* memory,
                                   std::uint32_t count, const VkBufferMemoryBarrier* list,
                                   std::uint32_t images, const VkImageMemoryBarrier* image) {
  std::vector<VkBufferMemoryBarrier> real(list, list + count);
  {
    const std::lock_guard lock(mutex);
    const std::uint32_t family = family_of(commands);
    for (VkBufferMemoryBarrier& each : real) {
      const std::uint32_t source = std::exchange(each.srcQueueFamilyIndex, kNone);
      const std::uint32_t target = std::exchange(each.dstQueueFamilyIndex, kNone);
      if (source == target) continue;
      Sharing& sharing = buffers[each.buffer];
      if (family == source) {
        touch(each.buffer, source);
        sharing.owner = target;
      } else if (family != target || sharing.owner != target) {
        blame(named(family) + " acquires what " + named(source) + " has not released");
      }
    }
  }
  next_of_device<PFN_vkCmdPipelineBarrier>(commands, "vkCmdPipelineBarrier")(
      commands, from, to, flags, memories, memory, count, real.data(), images, image);
}

}  // namespace

void ask_for_one_family(DeviceWish& wish) {
  const std::lock_guard lock(mutex);
  for (const VkDeviceQueueCreateInfo& queues : wish.queues) {
    if (queues.queueFamilyIndex >= kKinds.size() || queues.queueCount != 1) {
      blame("a device with more queues than there are");
    }
    asked.insert(queues.queueFamilyIndex);
    tell("queues of " + named(queues.queueFamilyIndex) + " were asked for");
  }
  wish.queues.resize(1);
  wish.queues.front().queueFamilyIndex = kReal;
}

PFN_vkVoidFunction families(const char* name) {
  static const std::map<std::string, PFN_vkVoidFunction, std::less<>> ours{
      {"vkGetPhysicalDeviceQueueFamilyProperties", as_void(&get_families)},
      {"vkGetDeviceQueue", as_void(&get_queue)},
      {"vkCreateCommandPool", as_void(&create_pool)},
      {"vkAllocateCommandBuffers", as_void(&allocate_commands)},
      {"vkCreateBuffer", as_void(&create_buffer)},
      {"vkCreateBufferView", as_void(&create_view)},
      {"vkAllocateDescriptorSets", as_void(&allocate_sets)},
      {"vkUpdateDescriptorSets", as_void(&update_sets)},
      {"vkCmdBindDescriptorSets", as_void(&bind_sets)},
      {"vkCmdCopyBuffer", as_void(&copy)},
      {"vkCmdFillBuffer", as_void(&fill)},
      {"vkCmdPipelineBarrier", as_void(&barrier)},
  };
  const auto found = ours.find(name);
  return found == ours.end() ? nullptr : found->second;
}

}  // namespace sunder::layer
