// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/gather.hpp"

#include <algorithm>

#include "gpu/passes/two_floats.hpp"

namespace sunder::gpu {

using vulkan::Buffer;
using vulkan::Placement;

namespace {

constexpr std::uint32_t kFirstRoom = 3 * 64;  // 64 nodes: no frame makes room for a host's hands

}  // namespace

Gather::Gather(const KernelFactory& kernels, const Buffer& values)
    : device_(kernels.device()),
      single_(kernels.single()),
      values_(values),
      kernel_(kernels.make_fp64("gather")),
      commands_(kernels.device()) {
  make_room(kFirstRoom);
}

void Gather::make_room(std::uint32_t count) {
  if (count <= room_) return;
  room_ = std::max(round_up(count, shaders::kGroup), 2 * room_);
  binding_.reset();
  places_ = Buffer(device_, room_ * sizeof(std::uint32_t), Placement::staging);
  picked_ = Buffer(device_, room_ * sizeof(double), Placement::staging);
  const Buffer* buffers[] = {&values_, &places_, &picked_};
  binding_ = std::make_unique<vulkan::Binding>(device_, *kernel_, buffers);
}

void Gather::read(std::span<const std::uint32_t> places, std::span<double> picked) {
  if (places.empty()) return;
  const auto count = static_cast<std::uint32_t>(places.size());
  make_room(count);
  std::copy(places.begin(), places.end(), places_.mapped<std::uint32_t>());
  commands_.begin();
  commands_.pass("gather");
  commands_.dispatch(*binding_, shaders::GatherPush{count},
                     round_up(count, shaders::kGroup) / shaders::kGroup);
  commands_.end();
  commands_.submit();
  picked_.read(picked.first(places.size()));
  if (single_) join_two_floats(picked.first(places.size()));
}

}  // namespace sunder::gpu
