// SPDX-License-Identifier: Apache-2.0
// Commands between two barriers may run in any order and at once; lavapipe runs them one after the
// other as they were recorded, so that a barrier that is missing changes nothing there. Here they
// are held back until a barrier or the end of the command buffer comes, and recorded in reverse.
#include <cstring>
#include <functional>
#include <map>
#include <mutex>
#include <utility>

#include "layer.hpp"

namespace sunder::layer {
namespace {

/// What a dispatch takes with it.
struct Bound {
  VkPipeline pipeline = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE, push_layout = VK_NULL_HANDLE;
  std::vector<VkDescriptorSet> sets;
  std::vector<std::byte> push;
};
struct Recorded {
  Bound bound;
  std::vector<std::function<void()>> held;
};

std::mutex mutex;
std::map<VkCommandBuffer, Recorded> all;

/// How often commands changed places, told at the end: a test that none has is no test.
struct Turned {
  std::size_t groups = 0, commands = 0;
  ~Turned() {
    if (groups == 0) return;
    tell(std::to_string(commands) + " commands of " + std::to_string(groups) +
         " groups ran in reverse order");
  }
} turned;

Recorded& of(VkCommandBuffer commands) {
  const std::lock_guard lock(mutex);
  return all[commands];
}

void hold(VkCommandBuffer commands, std::function<void()> command) {
  of(commands).held.push_back(std::move(command));
}

void let_go(VkCommandBuffer commands) {
  std::vector<std::function<void()>> held;
  std::swap(held, of(commands).held);
  if (held.size() > 1) {
    const std::lock_guard lock(mutex);
    ++turned.groups;
    turned.commands += held.size();
  }
  for (auto command = held.rbegin(); command != held.rend(); ++command) (*command)();
}

void bind(VkCommandBuffer commands, const Bound& bound) {
  next_of_device<PFN_vkCmdBindPipeline>(commands, "vkCmdBindPipeline")(
      commands, VK_PIPELINE_BIND_POINT_COMPUTE, bound.pipeline);
  next_of_device<PFN_vkCmdBindDescriptorSets>(commands, "vkCmdBindDescriptorSets")(
      commands, VK_PIPELINE_BIND_POINT_COMPUTE, bound.layout, 0,
      static_cast<std::uint32_t>(bound.sets.size()), bound.sets.data(), 0, nullptr);
  if (bound.push.empty()) return;
  next_of_device<PFN_vkCmdPushConstants>(commands, "vkCmdPushConstants")(
      commands, bound.push_layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
      static_cast<std::uint32_t>(bound.push.size()), bound.push.data());
}

VKAPI_ATTR void VKAPI_CALL bind_pipeline(VkCommandBuffer commands, VkPipelineBindPoint point,
                                         VkPipeline pipeline) {
  if (point == VK_PIPELINE_BIND_POINT_COMPUTE) {
    of(commands).bound.pipeline = pipeline;
    return;
  }
  next_of_device<PFN_vkCmdBindPipeline>(commands, "vkCmdBindPipeline")(commands, point, pipeline);
}
VKAPI_ATTR void VKAPI_CALL bind_sets(VkCommandBuffer commands, VkPipelineBindPoint point,
                                     VkPipelineLayout layout, std::uint32_t first,
                                     std::uint32_t count, const VkDescriptorSet* sets,
                                     std::uint32_t offsets, const std::uint32_t* dynamic) {
  if (point != VK_PIPELINE_BIND_POINT_COMPUTE || first != 0 || offsets != 0) {
    next_of_device<PFN_vkCmdBindDescriptorSets>(commands, "vkCmdBindDescriptorSets")(
        commands, point, layout, first, count, sets, offsets, dynamic);
    return;
  }
  Bound& bound = of(commands).bound;
  bound.layout = layout;
  bound.sets.assign(sets, sets + count);
  bound.push.clear();  // of another kernel
}
VKAPI_ATTR void VKAPI_CALL push(VkCommandBuffer commands, VkPipelineLayout layout,
                                VkShaderStageFlags stages, std::uint32_t offset,
                                std::uint32_t bytes, const void* values) {
  if (stages != VK_SHADER_STAGE_COMPUTE_BIT) {
    next_of_device<PFN_vkCmdPushConstants>(commands, "vkCmdPushConstants")(commands, layout, stages,
                                                                           offset, bytes, values);
    return;
  }
  Bound& bound = of(commands).bound;
  bound.push_layout = layout;
  if (bound.push.size() < offset + bytes) bound.push.resize(offset + bytes);
  std::memcpy(bound.push.data() + offset, values, bytes);
}

VKAPI_ATTR void VKAPI_CALL dispatch(VkCommandBuffer commands, std::uint32_t x, std::uint32_t y,
                                    std::uint32_t z) {
  hold(commands, [=, bound = of(commands).bound] {
    bind(commands, bound);
    next_of_device<PFN_vkCmdDispatch>(commands, "vkCmdDispatch")(commands, x, y, z);
  });
}
VKAPI_ATTR void VKAPI_CALL dispatch_base(VkCommandBuffer commands, std::uint32_t base_x,
                                         std::uint32_t base_y, std::uint32_t base_z,
                                         std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  hold(commands, [=, bound = of(commands).bound] {
    bind(commands, bound);
    next_of_device<PFN_vkCmdDispatchBase>(commands, "vkCmdDispatchBase")(commands, base_x, base_y,
                                                                         base_z, x, y, z);
  });
}
VKAPI_ATTR void VKAPI_CALL dispatch_indirect(VkCommandBuffer commands, VkBuffer buffer,
                                             VkDeviceSize offset) {
  hold(commands, [=, bound = of(commands).bound] {
    bind(commands, bound);
    next_of_device<PFN_vkCmdDispatchIndirect>(commands, "vkCmdDispatchIndirect")(commands, buffer,
                                                                                 offset);
  });
}
VKAPI_ATTR void VKAPI_CALL copy(VkCommandBuffer commands, VkBuffer from, VkBuffer to,
                                std::uint32_t count, const VkBufferCopy* regions) {
  hold(commands, [=, list = std::vector<VkBufferCopy>(regions, regions + count)] {
    next_of_device<PFN_vkCmdCopyBuffer>(commands, "vkCmdCopyBuffer")(commands, from, to, count,
                                                                     list.data());
  });
}
VKAPI_ATTR void VKAPI_CALL fill(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                                VkDeviceSize bytes, std::uint32_t value) {
  hold(commands, [=] {
    next_of_device<PFN_vkCmdFillBuffer>(commands, "vkCmdFillBuffer")(commands, buffer, offset,
                                                                     bytes, value);
  });
}

VKAPI_ATTR void VKAPI_CALL barrier(VkCommandBuffer commands, VkPipelineStageFlags from,
                                   VkPipelineStageFlags to, VkDependencyFlags flags,
                                   std::uint32_t memories, const VkMemoryBarrier* memory,
                                   std::uint32_t buffers, const VkBufferMemoryBarrier* buffer,
                                   std::uint32_t images, const VkImageMemoryBarrier* image) {
  let_go(commands);
  next_of_device<PFN_vkCmdPipelineBarrier>(commands, "vkCmdPipelineBarrier")(
      commands, from, to, flags, memories, memory, buffers, buffer, images, image);
}
VKAPI_ATTR void VKAPI_CALL stamp(VkCommandBuffer commands, VkPipelineStageFlagBits stage,
                                 VkQueryPool pool, std::uint32_t query) {
  let_go(commands);
  next_of_device<PFN_vkCmdWriteTimestamp>(commands, "vkCmdWriteTimestamp")(commands, stage, pool,
                                                                           query);
}
VKAPI_ATTR VkResult VKAPI_CALL begin(VkCommandBuffer commands,
                                     const VkCommandBufferBeginInfo* info) {
  of(commands) = {};
  return next_of_device<PFN_vkBeginCommandBuffer>(commands, "vkBeginCommandBuffer")(commands, info);
}
VKAPI_ATTR VkResult VKAPI_CALL end(VkCommandBuffer commands) {
  let_go(commands);
  return next_of_device<PFN_vkEndCommandBuffer>(commands, "vkEndCommandBuffer")(commands);
}

}  // namespace

PFN_vkVoidFunction backwards(const char* name) {
  static const std::map<std::string, PFN_vkVoidFunction, std::less<>> ours{
      {"vkCmdBindPipeline", as_void(&bind_pipeline)},
      {"vkCmdBindDescriptorSets", as_void(&bind_sets)},
      {"vkCmdPushConstants", as_void(&push)},
      {"vkCmdDispatch", as_void(&dispatch)},
      {"vkCmdDispatchBase", as_void(&dispatch_base)},
      {"vkCmdDispatchIndirect", as_void(&dispatch_indirect)},
      {"vkCmdCopyBuffer", as_void(&copy)},
      {"vkCmdFillBuffer", as_void(&fill)},
      {"vkCmdPipelineBarrier", as_void(&barrier)},
      {"vkCmdWriteTimestamp", as_void(&stamp)},
      {"vkBeginCommandBuffer", as_void(&begin)},
      {"vkEndCommandBuffer", as_void(&end)},
  };
  const auto found = ours.find(name);
  return found == ours.end() ? nullptr : found->second;
}

}  // namespace sunder::layer
