// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/uploads.hpp"

#include <algorithm>
#include <cstring>

namespace sunder::vulkan {
namespace {

constexpr std::size_t kRoom = std::size_t{32} << 20;  // bytes: a hundred elements' columns
constexpr std::size_t kCopies = 4096, kReads = 64;    // of so many no list grows
constexpr auto kZeros = static_cast<std::size_t>(-1);

/// Also where a submit fails: nobody may write to where the bytes would have gone.
template <class List>
struct Forgotten {
  List& list;
  ~Forgotten() { list.clear(); }
};

}  // namespace

Uploads::Uploads(Device& device)
    : device_(device), room_(device, kRoom, Placement::staging), copies_(device), reads_(device) {
  waiting_.reserve(kCopies);
  wanted_.reserve(kReads);
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

void Uploads::want(VkBuffer from, std::size_t offset, std::span<std::byte> data) {
  while (!data.empty()) {  // in parts that have room each
    const std::size_t part = std::min(data.size(), kRoom);
    wanted_.push_back({from, offset, data.first(part), 0});
    offset += part;
    data = data.subspan(part);
  }
}

void Uploads::read() {
  const Forgotten<std::vector<Read>> at_the_end{wanted_};
  for (std::size_t first = 0; first < wanted_.size();) {
    if (left() < wanted_[first].to.size()) device_.flush();
    std::size_t last = first, at = used_;
    reads_.begin();
    for (; last < wanted_.size() && wanted_[last].to.size() <= kRoom - at; ++last) {
      Read& next = wanted_[last];
      next.at = at;
      reads_.copy(next.from, next.offset, room_.handle(), room_.offset() + at, next.to.size());
      at += Buffer::padded(next.to.size());
    }
    reads_.end();
    reads_.submit();
    for (; first < last; ++first) {
      const Read& done = wanted_[first];
      std::memcpy(done.to.data(), room_.mapped<std::byte>() + done.at, done.to.size());
    }
  }
}

void Uploads::forget(VkBuffer buffer) noexcept {
  std::erase_if(waiting_, [&](const Copy& copy) { return copy.to == buffer; });
  if (waiting_.empty()) used_ = 0;
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
  copies_.end();
  return copies_.handle();
}

void Uploads::clear() noexcept {
  waiting_.clear();
  used_ = 0;
}

}  // namespace sunder::vulkan
