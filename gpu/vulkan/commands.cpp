// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/commands.hpp"

#include <algorithm>
#include <utility>

#include "gpu/vulkan/check.hpp"
#include "gpu/vulkan/folded_groups.hpp"

namespace sunder::vulkan {
namespace {

constexpr std::uint32_t kMaxTimes = 64;  // time stamps of one command buffer

// Of what comes next in a command buffer.
constexpr VkPipelineStageFlags kComputeStages = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                                                VK_PIPELINE_STAGE_TRANSFER_BIT |
                                                VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT;
constexpr VkAccessFlags kComputeAccess =
    VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT |
    VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_INDIRECT_COMMAND_READ_BIT;

}  // namespace

Commands::Commands(Device& device) : device_(device) {
  VkCommandBufferAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  info.commandPool = device.command_pool();
  info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  info.commandBufferCount = 1;
  check(device.vk().AllocateCommandBuffers(device.handle(), &info, &handle_),
        "vkAllocateCommandBuffers");
}

Commands::~Commands() {
  device_.vk().DestroyQueryPool(device_.handle(), queries_, nullptr);
  device_.vk().FreeCommandBuffers(device_.handle(), device_.command_pool(), 1, &handle_);
}

void Commands::begin() {
  device_.queue().check_answers();
  passes_.clear();
  uses_.clear();
  barriers_ = 0;
  dispatches_ = 0;
  VkCommandBufferBeginInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  check(device_.vk().BeginCommandBuffer(handle_, &info), "vkBeginCommandBuffer");
  if (queries_) device_.vk().CmdResetQueryPool(handle_, queries_, 0, kMaxTimes);
}

void Commands::end() {
  if (!passes_.empty()) write_time();
  memory_barrier(VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT,
                 VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT | VK_ACCESS_HOST_READ_BIT);
  check(device_.vk().EndCommandBuffer(handle_), "vkEndCommandBuffer");
}

void Commands::submit(const Commands* then) {
  device_.submit(handle_, then ? then->handle_ : VK_NULL_HANDLE);
  count();
  if (then) then->count();
}

void Commands::count() const {
  device_.count_dispatches(dispatches_);
  for (const PassTime& time : pass_times()) device_.add_time(time.pass, time.milliseconds);
}

void Commands::pass(const char* name) {
  if (!device_.timing() || passes_.size() + 1 >= kMaxTimes) return;
  if (!queries_) {
    VkQueryPoolCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = kMaxTimes;
    check(device_.vk().CreateQueryPool(device_.handle(), &info, nullptr, &queries_),
          "vkCreateQueryPool");
    device_.vk().CmdResetQueryPool(handle_, queries_, 0, kMaxTimes);
  }
  write_time();
  passes_.push_back(name);
}

void Commands::write_time() {
  device_.vk().CmdWriteTimestamp(handle_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_,
                                 static_cast<std::uint32_t>(passes_.size()));
}

void Commands::bind(const Binding& binding, const void* push, std::uint32_t bytes) {
  const Kernel& kernel = binding.kernel();
  const VkDescriptorSet set = binding.set();
  const DeviceFunctions& vk = device_.vk();
  vk.CmdBindPipeline(handle_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline());
  vk.CmdBindDescriptorSets(handle_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout(), 0, 1, &set, 0,
                           nullptr);
  if (kernel.push_bytes() > 0) {
    vk.CmdPushConstants(handle_, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, bytes, push);
  }
}

void Commands::dispatch(const Kernel& kernel, std::uint32_t x, std::uint32_t y) {
  const FoldedGroups groups(device_.physical(), kernel, x, y);
  ++dispatches_;
  device_.count_recorded();
  groups.dispatch_rows(device_.vk(), handle_);
  if (groups.rest == 0) return;
  // Other bytes than the rows': the barrier is for those who watch.
  memory_barrier(kComputeStages, kComputeAccess);
  groups.dispatch_rest(device_.vk(), handle_);
}

void Commands::dispatch_indirect(const Buffer& arguments, std::size_t offset) {
  ++dispatches_;
  device_.count_recorded();
  device_.vk().CmdDispatchIndirect(handle_, arguments.handle(), arguments.offset() + offset);
}

void Commands::wait_for(const Binding& binding, const Buffer& arguments, std::size_t offset) {
  const std::size_t begin = arguments.offset() + offset;
  const MemoryUse size{
      arguments.handle(), begin, begin + sizeof(VkDispatchIndirectCommand), {.reads = true}};
  wait_for(binding.uses(), {&size, 1});
}

void Commands::wait_for(std::span<const MemoryUse> uses, std::span<const MemoryUse> size) {
  if (uses_.conflict(uses, std::exchange(apart_, false)) || uses_.conflict(size)) {
    memory_barrier(kComputeStages, kComputeAccess);
    uses_.clear();
    ++barriers_;
  }
  uses_.add(uses);
  uses_.add(size);
}

void Commands::memory_barrier(VkPipelineStageFlags to_stages, VkAccessFlags to) {
  VkMemoryBarrier all{};
  all.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  all.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  all.dstAccessMask = to;
  device_.vk().CmdPipelineBarrier(
      handle_, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT, to_stages, 0,
      1, &all, 0, nullptr, 0, nullptr);
}

void Commands::copy(VkBuffer from, std::size_t from_offset, VkBuffer to, std::size_t to_offset,
                    std::size_t bytes) {
  const MemoryUse uses[] = {{from, from_offset, from_offset + bytes, {.reads = true}},
                            {to, to_offset, to_offset + bytes, {.writes = true}}};
  wait_for(uses);
  const VkBufferCopy region{from_offset, to_offset, bytes};
  device_.vk().CmdCopyBuffer(handle_, from, to, 1, &region);
}

void Commands::fill_zero(VkBuffer to, std::size_t to_offset, std::size_t bytes) {
  const MemoryUse use{to, to_offset, to_offset + bytes, {.writes = true}};
  wait_for({&use, 1});
  device_.vk().CmdFillBuffer(handle_, to, to_offset, bytes, 0);
}

std::vector<PassTime> Commands::pass_times() const {
  std::vector<PassTime> times;
  if (passes_.empty()) return times;
  std::vector<std::uint64_t> ticks(passes_.size() + 1);
  check(device_.vk().GetQueryPoolResults(
            device_.handle(), queries_, 0, static_cast<std::uint32_t>(ticks.size()),
            ticks.size() * sizeof(std::uint64_t), ticks.data(), sizeof(std::uint64_t),
            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "vkGetQueryPoolResults");
  const std::uint32_t bits = device_.physical().timestamp_bits;
  const std::uint64_t mask = bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  for (std::size_t p = 0; p < passes_.size(); ++p) {
    const double ms = static_cast<double>((ticks[p + 1] - ticks[p]) & mask) *
                      device_.physical().timestamp_period * 1e-6;
    const auto same = std::find_if(times.begin(), times.end(),
                                   [&](const PassTime& t) { return t.is(passes_[p]); });
    if (same == times.end()) {
      times.push_back({passes_[p], ms});
    } else {
      same->milliseconds += ms;
    }
  }
  return times;
}

}  // namespace sunder::vulkan
