// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/uploads.hpp"

#include <algorithm>
#include <cstring>

namespace sunder::vulkan {
namespace {

constexpr std::size_t kRoom = std::size_t{32} << 20;  // bytes: a hundred elements' columns
constexpr std::size_t kCopies = 4096;                 // of so many no list grows
constexpr auto kZeros = static_cast<std::size_t>(-1);

}  // namespace

Uploads::Uploads(Device& device)
    : device_(device), room_(device, kRoom, Placement::staging), copies_(device), reads_(device) {
  waiting_.reserve(kCopies);
}

std::size_t Uploads::left() const { return kRoom - used_; }

void Uploads::write(VkBuffer to, std::size_t offset, std::span<const std::byte> data) {
  while (!data.empty()) {
    if (left() < std::min(data.size(), kRoom)) device_.flush();
    const std::size_t part = std::min(data.size(), left());
    std::memcpy(room_.mapped<std::byte>() + used_, data.data(), part);
    waiting_.push_back({to, offset, used_, part});
    used_ += Buffer::padded(part);
    offset += part;
    data = data.subspan(part);
  }
}

void Uploads::fill_zero(VkBuffer to, std::size_t offset, std::size_t bytes) {
  waiting_.push_back({to, offset, kZeros, bytes});
}

void Uploads::read(VkBuffer from, std::size_t offset, std::span<std::byte> data) {
  while (!data.empty()) {
    if (left() < std::min(data.size(), kRoom)) device_.flush();
    const std::size_t part = std::min(data.size(), left()), at = used_;
    reads_.begin();
    reads_.copy(from, offset, room_.handle(), room_.offset() + at, part);
    reads_.end();
    reads_.submit();
    std::memcpy(data.data(), room_.mapped<std::byte>() + at, part);
    offset += part;
    data = data.subspan(part);
  }
}

void Uploads::forget(VkBuffer buffer) noexcept {
  std::erase_if(waiting_, [&](const Copy& copy) { return copy.to == buffer; });
}

VkCommandBuffer Uploads::record() {
  if (waiting_.empty()) return VK_NULL_HANDLE;
  copies_.begin();
  for (const Copy& copy : waiting_) {
    if (copy.at == kZeros) {
      copies_.fill_zero(copy.to, copy.offset, copy.bytes);
    } else {
      copies_.copy(room_.handle(), room_.offset() + copy.at, copy.to, copy.offset, copy.bytes);
    }
  }
  copies_.end_for_all();
  return copies_.handle();
}

void Uploads::clear() noexcept {
  waiting_.clear();
  used_ = 0;
}

}  // namespace sunder::vulkan
