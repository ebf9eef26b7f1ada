// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/kernel.hpp"

#include <algorithm>

#include "gpu/vulkan/check.hpp"
#include "gpu/vulkan/shader_memory.hpp"

namespace sunder::vulkan {
namespace {

VkDescriptorType descriptor_type(Access access) {
  return access == Access::storage ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                   : VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
}

}  // namespace

Kernel::Kernel(Device& device, const KernelCode& code)
    : device_(device),
      name_(code.name),
      bindings_(code.bindings.begin(), code.bindings.end()),
      uses_(shader_uses(code.spirv)),
      push_bytes_(code.push_bytes) {
  uses_.resize(bindings_.size());
  check_limits(code);
  try {
    create_layouts();
    create_pipeline(code);
  } catch (...) {
    release();
    throw;
  }
}

Kernel::~Kernel() { release(); }

void Kernel::release() noexcept {
  if (pipeline_ != VK_NULL_HANDLE) device_.forget_pipeline(name_);
  device_.vk().DestroyPipeline(device_.handle(), pipeline_, nullptr);
  device_.vk().DestroyPipelineLayout(device_.handle(), layout_, nullptr);
  device_.vk().DestroyDescriptorSetLayout(device_.handle(), set_layout_, nullptr);
}

void Kernel::check_limits(const KernelCode& code) const {
  const PhysicalDevice& device = device_.physical();
  const Limits& limits = device.limits;
  const std::string who = "kernel " + name_;
  const auto storage = static_cast<std::uint64_t>(std::ranges::count(bindings_, Access::storage));
  device.require(storage, limits.storage_buffers, who);
  device.require(bindings_.size() - storage, limits.texel_buffers, who);
  device.require(bindings_.size(), limits.buffers, who);
  device.require(push_bytes_, limits.push_bytes, who);
  device.require(shared_bytes(code.spirv), limits.shared_bytes, who);
  if (!code.constants.empty()) device.require(code.constants.front(), limits.group, who);
}

void Kernel::create_layouts() {
  std::vector<VkDescriptorSetLayoutBinding> bindings(bindings_.size());
  for (std::uint32_t b = 0; b < bindings.size(); ++b) {
    bindings[b].binding = b;
    bindings[b].descriptorType = descriptor_type(bindings_[b]);
    bindings[b].descriptorCount = 1;
    bindings[b].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
  }
  VkDescriptorSetLayoutCreateInfo set{};
  set.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set.bindingCount = static_cast<std::uint32_t>(bindings.size());
  set.pBindings = bindings.data();
  check(device_.vk().CreateDescriptorSetLayout(device_.handle(), &set, nullptr, &set_layout_),
        "vkCreateDescriptorSetLayout");
  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes_};
  VkPipelineLayoutCreateInfo layout{};
  layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &set_layout_;
  layout.pushConstantRangeCount = push_bytes_ > 0 ? 1 : 0;
  layout.pPushConstantRanges = &push;
  check(device_.vk().CreatePipelineLayout(device_.handle(), &layout, nullptr, &layout_),
        "vkCreatePipelineLayout");
}

void Kernel::create_pipeline(const KernelCode& code) {
  VkShaderModuleCreateInfo module{};
  module.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module.codeSize = code.spirv.size_bytes();
  module.pCode = code.spirv.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  check(device_.vk().CreateShaderModule(device_.handle(), &module, nullptr, &shader),
        "vkCreateShaderModule");
  std::vector<std::uint32_t> constants(code.constants.begin(), code.constants.end());
  constants.push_back(static_cast<std::uint32_t>(device_.physical().limits.groups.value));
  constexpr std::uint32_t word = sizeof(std::uint32_t);
  std::vector<VkSpecializationMapEntry> entries(constants.size());
  for (std::uint32_t c = 0; c < entries.size(); ++c) entries[c] = {c, c * word, word};
  entries.back().constantID = kRowConstant;
  const VkSpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()),
                                            entries.data(), constants.size() * word,
                                            constants.data()};
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.flags = VK_PIPELINE_CREATE_DISPATCH_BASE_BIT;  // the last row of a folded dispatch
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = shader;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialization;
  VkPipelineShaderStageRequiredSubgroupSizeCreateInfo size{};
  size.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_REQUIRED_SUBGROUP_SIZE_CREATE_INFO;
  size.requiredSubgroupSize = code.subgroup;
  if (code.subgroup > 0 && device_.physical().subgroup_on_request) info.stage.pNext = &size;
  info.layout = layout_;
  const VkResult result = device_.vk().CreateComputePipelines(
      device_.handle(), device_.pipeline_cache(), 1, &info, nullptr, &pipeline_);
  device_.vk().DestroyShaderModule(device_.handle(), shader, nullptr);
  check(result, "vkCreateComputePipelines");
  device_.count_pipeline(name_);
}

Binding::Binding(Device& device, const Kernel& kernel, std::span<const Buffer* const> buffers)
    : device_(device), kernel_(kernel) {
  try {
    allocate();
    for (std::uint32_t b = 0; b < kernel.bindings().size(); ++b) {
      const Buffer& of = *buffers[b];
      write(b, kernel.bindings()[b], of);
      uses_.push_back(
          {of.handle(), of.offset(), of.offset() + of.bytes(), kernel.uses()[b], &kernel});
    }
  } catch (...) {
    release();
    throw;
  }
}

Binding::~Binding() { release(); }

void Binding::release() noexcept {
  for (VkBufferView view : views_) device_.vk().DestroyBufferView(device_.handle(), view, nullptr);
  device_.vk().DestroyDescriptorPool(device_.handle(), pool_, nullptr);
}

void Binding::allocate() {
  std::vector<VkDescriptorPoolSize> sizes;
  for (const Access access : kernel_.bindings()) sizes.push_back({descriptor_type(access), 1});
  VkDescriptorPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  pool.maxSets = 1;
  pool.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
  check(device_.vk().CreateDescriptorPool(device_.handle(), &pool, nullptr, &pool_),
        "vkCreateDescriptorPool");
  const VkDescriptorSetLayout layout = kernel_.set_layout();
  VkDescriptorSetAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  info.descriptorPool = pool_;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  check(device_.vk().AllocateDescriptorSets(device_.handle(), &info, &set_),
        "vkAllocateDescriptorSets");
}

void Binding::check_limits(Access access, const Buffer& buffer) const {
  const PhysicalDevice& device = device_.physical();
  const Limits& limits = device.limits;
  const std::string who = "kernel " + kernel_.name();
  constexpr std::size_t texel = 16;
  if (access == Access::storage) {
    device.require(buffer.bytes(), limits.buffer_bytes, who);
  } else {
    device.require(buffer.bytes() / texel, limits.texels, who);
  }
  if (buffer.offset() % limits.alignment == 0) return;
  throw DeviceError(who + " is to see a buffer from byte " + std::to_string(buffer.offset()) +
                    " on, but the Vulkan device \"" + device.name + "\" binds at multiples of " +
                    std::to_string(limits.alignment) +
                    " (minStorageBufferOffsetAlignment, minTexelBufferOffsetAlignment)");
}

void Binding::write(std::uint32_t binding, Access access, const Buffer& buffer) {
  check_limits(access, buffer);
  VkWriteDescriptorSet write{};
  write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
  write.dstSet = set_;
  write.dstBinding = binding;
  write.descriptorCount = 1;
  write.descriptorType = descriptor_type(access);
  const VkDescriptorBufferInfo range{buffer.handle(), buffer.offset(), buffer.range()};
  VkBufferView view = VK_NULL_HANDLE;
  if (access == Access::storage) {
    write.pBufferInfo = &range;
  } else {
    VkBufferViewCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO;
    info.buffer = buffer.handle();
    info.format = access == Access::texel_float4 ? VK_FORMAT_R32G32B32A32_SFLOAT
                                                 : VK_FORMAT_R32G32B32A32_UINT;
    info.offset = buffer.offset();
    info.range = buffer.range();
    check(device_.vk().CreateBufferView(device_.handle(), &info, nullptr, &view),
          "vkCreateBufferView");
    views_.push_back(view);
    write.pTexelBufferView = &view;
  }
  device_.vk().UpdateDescriptorSets(device_.handle(), 1, &write, 0, nullptr);
}

}  // namespace sunder::vulkan
