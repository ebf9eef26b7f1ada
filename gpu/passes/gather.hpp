// SPDX-License-Identifier: Apache-2.0
// Reads some values of a buffer: the device puts them side by side, so that only they cross to the
// host (a ring of nodes round a crack's tip, a grip's reactions).
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "gpu/kernels.hpp"
#include "gpu/vulkan/commands.hpp"

namespace sunder::gpu {

class Gather {
 public:
  /// `values`: fp64, or two floats each where the device has no fp64; it must outlive this and stay
  /// where it is.
  Gather(const KernelFactory& kernels, const vulkan::Buffer& values);

  /// picked[i] = values[places[i]], in one submit.
  void read(std::span<const std::uint32_t> places, std::span<double> picked);

 private:
  void make_room(std::uint32_t count);

  vulkan::Device& device_;
  bool single_;
  const vulkan::Buffer& values_;
  std::unique_ptr<vulkan::Kernel> kernel_;
  std::uint32_t room_ = 0;
  vulkan::Buffer places_, picked_;
  std::unique_ptr<vulkan::Binding> binding_;
  vulkan::Commands commands_;
};

}  // namespace sunder::gpu
