// SPDX-License-Identifier: Apache-2.0
// A compute pipeline and the buffers bound to it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gpu/vulkan/buffer.hpp"
#include "gpu/vulkan/memory_uses.hpp"

namespace sunder::vulkan {

/// Specialization constant that every kernel gets beside its own: the workgroups of a row, where a
/// dispatch is folded (shaders/common.glsl).
inline constexpr std::uint32_t kRowConstant = 3;

/// How a kernel sees a buffer.
enum class Access : std::uint8_t {
  storage,       ///< a storage buffer
  texel_float4,  ///< a texel buffer of vec4 (the lvp variant's way to read fp32)
  texel_uint4,   ///< a texel buffer of uvec4 (words, and fp64 in pairs)
};

struct KernelCode {
  std::span<const std::uint32_t> spirv;
  std::span<const Access> bindings;  ///< in order of binding
  std::uint32_t push_bytes = 0;
  /// Specialization constants, in order of id: fewer than kRowConstant, the first one the
  /// invocations of a workgroup.
  std::span<const std::uint32_t> constants;
  std::string name = {};
  std::uint32_t subgroup = 0;  ///< invocations that it counts on, 0: any number
};

class Kernel {
 public:
  Kernel(Device& device, const KernelCode& code);
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] VkPipeline pipeline() const { return pipeline_; }
  [[nodiscard]] VkPipelineLayout layout() const { return layout_; }
  [[nodiscard]] VkDescriptorSetLayout set_layout() const { return set_layout_; }
  [[nodiscard]] const std::vector<Access>& bindings() const { return bindings_; }
  [[nodiscard]] std::uint32_t push_bytes() const { return push_bytes_; }
  /// What its code does with each binding.
  [[nodiscard]] const std::vector<Use>& uses() const { return uses_; }

 private:
  void check_limits(const KernelCode& code) const;
  void create_layouts();
  void create_pipeline(const KernelCode& code);
  void release() noexcept;

  Device& device_;
  std::string name_;
  std::vector<Access> bindings_;
  std::vector<Use> uses_;
  std::uint32_t push_bytes_;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

/// The buffers of one kernel, written once. They must outlive it.
class Binding {
 public:
  Binding(Device& device, const Kernel& kernel, std::span<const Buffer* const> buffers);
  ~Binding();
  Binding(const Binding&) = delete;
  Binding& operator=(const Binding&) = delete;

  [[nodiscard]] const Kernel& kernel() const { return kernel_; }
  [[nodiscard]] VkDescriptorSet set() const { return set_; }
  /// What a dispatch does with the buffers.
  [[nodiscard]] std::span<const MemoryUse> uses() const { return uses_; }

 private:
  void allocate();
  void check_limits(Access access, const Buffer& buffer) const;
  void write(std::uint32_t binding, Access access, const Buffer& buffer);
  void release() noexcept;

  Device& device_;
  const Kernel& kernel_;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  std::vector<VkBufferView> views_;
  std::vector<MemoryUse> uses_;
};

}  // namespace sunder::vulkan
