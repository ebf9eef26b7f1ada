// SPDX-License-Identifier: Apache-2.0
// Turns embedded kernels into pipelines, in the variant that suits the driver.
#pragma once

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "gpu/kernel_table.hpp"
#include "gpu/vulkan/kernel.hpp"
#include "shaders/layout.h"
#include "sunder/backend.hpp"

namespace sunder::gpu {

[[nodiscard]] constexpr std::uint32_t round_up(std::uint32_t value, std::uint32_t to) {
  return (value + to - 1) / to * to;
}

/// How kernels read (shaders/common.glsl).
enum class Variant { gpu, lvp };

class KernelFactory {
 public:
  /// `fp64`: storage precision of the inverse and of element stress.
  KernelFactory(vulkan::Device& device, Variant variant, bool fp64)
      : device_(device), variant_(variant), fp64_(fp64) {}

  /// A kernel of the table in storage precision; `choice`: its third specialization constant, where
  /// it has one.
  [[nodiscard]] std::unique_ptr<vulkan::Kernel> make(std::string_view name,
                                                     std::uint32_t group = shaders::kGroup,
                                                     std::uint32_t choice = 0) const {
    return make(name, fp64_, group, choice);
  }
  /// A kernel that computes in fp64 always (in two floats where the device has none).
  [[nodiscard]] std::unique_ptr<vulkan::Kernel> make_fp64(std::string_view name) const {
    return make(name, true, shaders::kGroup, 0);
  }

  /// The same kernels with fp64 as storage precision.
  [[nodiscard]] KernelFactory in_fp64() const { return {device_, variant_, true}; }
  [[nodiscard]] KernelFactory in_fp32() const { return {device_, variant_, false}; }
  [[nodiscard]] vulkan::Device& device() const { return device_; }
  [[nodiscard]] bool fp64() const { return fp64_; }
  /// Kernels for a processor that emulates a device.
  [[nodiscard]] bool emulated() const { return variant_ == Variant::lvp; }
  /// The device has no fp64 at all: what would be fp64 is two floats, or the host's.
  [[nodiscard]] bool single() const { return !device_.physical().float64; }
  [[nodiscard]] std::size_t real_bytes() const { return fp64_ ? 8 : 4; }
  /// Partial results that a workgroup leaves behind (shaders/reduce.glsl).
  [[nodiscard]] std::uint32_t parts() const;
  /// Invocations of a workgroup that leaves one sum: for lavapipe, where a barrier makes every
  /// subgroup a coroutine, no more than one subgroup.
  [[nodiscard]] std::uint32_t summing_group() const {
    return emulated() ? device_.physical().subgroup : shaders::kGroup;
  }
  /// The same of a workgroup that leaves the one sum of all others' results: on a device more,
  /// since each waits for what it reads.
  [[nodiscard]] std::uint32_t closing_group() const {
    constexpr std::uint64_t kMost = shaders::kClosingGroup;
    if (emulated()) return summing_group();
    return static_cast<std::uint32_t>(std::min(kMost, device_.physical().limits.group.value));
  }
  /// Invocations of a workgroup of the low-rank update, and the columns that it updates
  /// (shaders/low_rank.comp).
  [[nodiscard]] std::uint32_t low_rank_group() const {
    if (!emulated()) return shaders::kGroup;
    return shaders::kTile / (fp64_ ? 4 : 8);  // that have a tile's rows between them
  }
  [[nodiscard]] std::uint32_t low_rank_columns(bool one_block) const {
    if (emulated()) return (one_block ? shaders::kUpdateTurns : 1) * shaders::kUpdateColumns;
    return shaders::kGroup / (shaders::kTile / 4) * shaders::kUpdateColumns;
  }

 private:
  [[nodiscard]] std::unique_ptr<vulkan::Kernel> make(std::string_view name, bool fp64,
                                                     std::uint32_t group,
                                                     std::uint32_t choice) const;

  vulkan::Device& device_;
  Variant variant_;
  bool fp64_;
};

/// How a binding is bound in a variant: of a kernel that computes in fp64 or not, on a device that
/// has fp64 or (`single`) has none.
[[nodiscard]] vulkan::Access access(Reads reads, Variant variant, bool fp64, bool single);

/// What pipelines do, by the names of their kernels, each name once.
[[nodiscard]] std::vector<KernelPlan> describe(const std::multiset<std::string>& pipelines);

/// lvp on lavapipe, gpu elsewhere; SUNDER_SHADER_VARIANT=gpu|lvp overrides. Throws UsageError for
/// another value, and for lvp where the device lacks what it needs.
[[nodiscard]] Variant choose_variant(const vulkan::PhysicalDevice& device);

}  // namespace sunder::gpu
