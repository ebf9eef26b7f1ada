// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/buffer.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "gpu/vulkan/check.hpp"
#include "gpu/vulkan/commands.hpp"
#include "gpu/vulkan/uploads.hpp"

namespace sunder::vulkan {
namespace {

constexpr unsigned char kSentinel = 0xa5;

constexpr VkMemoryPropertyFlags kVisible = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                           VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                                kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                                // What the host reads is quick to read where it is cached.
    kRead = kVisible | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

void copy(Device& device, VkBuffer from, std::size_t from_offset, VkBuffer to,
          std::size_t to_offset, std::size_t bytes) {
  Commands commands(device);
  commands.begin();
  commands.copy(from, from_offset, to, to_offset, bytes);
  commands.end();
  commands.submit();
}

}  // namespace

std::span<const VkMemoryPropertyFlags> memory_wishes(Placement placement, bool maps) {
  static constexpr VkMemoryPropertyFlags kMapped[] = {kLocal | kRead, kLocal | kVisible, kLocal},
                                         kUnmapped[] = {kLocal},
                                         kSent[] = {kLocal | kRead, kLocal | kVisible, kVisible},
                                         kOfHost[] = {kRead, kVisible};
  if (placement == Placement::sent && maps) return kSent;
  if (placement != Placement::device) return kOfHost;
  if (maps) return kMapped;
  return kUnmapped;
}

Buffer::Buffer(Device& device, std::size_t bytes, Placement placement)
    : device_(&device), bytes_(padded(bytes)), guard_(device.guard_bytes()) {
  try {
    create();
    allocate(placement);
    write_guards();
    counted_ = placement != Placement::staging;
    if (counted_) device_->count_buffer(static_cast<std::ptrdiff_t>(bytes_));
  } catch (...) {
    release();
    throw;
  }
}

Buffer Buffer::lent(VkBuffer buffer, std::size_t offset, std::size_t bytes) {
  Buffer result;
  result.handle_ = buffer;
  result.guard_ = offset;
  result.bytes_ = bytes;
  return result;
}

Buffer::~Buffer() { release(); }

Buffer::Buffer(Buffer&& other) noexcept { *this = std::move(other); }

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  if (this == &other) return *this;
  release();
  device_ = std::exchange(other.device_, nullptr);
  bytes_ = std::exchange(other.bytes_, 0);
  guard_ = std::exchange(other.guard_, 0);
  handle_ = std::exchange(other.handle_, VK_NULL_HANDLE);
  memory_ = std::exchange(other.memory_, VK_NULL_HANDLE);
  mapped_ = std::exchange(other.mapped_, nullptr);
  counted_ = std::exchange(other.counted_, false);
  counted_memory_ = std::exchange(other.counted_memory_, false);
  read_there_ = std::exchange(other.read_there_, false);
  return *this;
}

void Buffer::release() noexcept {
  if (!device_) return;
  if (!mapped_) device_->forget(handle_);
  check_guards();
  if (counted_) device_->count_buffer(-static_cast<std::ptrdiff_t>(bytes_));
  device_->vk().DestroyBuffer(device_->handle(), handle_, nullptr);
  device_->vk().FreeMemory(device_->handle(), memory_, nullptr);
  if (counted_memory_) device_->forget_allocation();
  device_ = nullptr;
}

void Buffer::create() {
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = bytes_ + 2 * guard_;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
               VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
  info.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  check(device_->vk().CreateBuffer(device_->handle(), &info, nullptr, &handle_), "vkCreateBuffer");
}

void Buffer::allocate(Placement placement) {
  const DeviceFunctions& vk = device_->vk();
  VkMemoryRequirements needed{};
  vk.GetBufferMemoryRequirements(device_->handle(), handle_, &needed);
  const PhysicalDevice& physical = device_->physical();
  physical.require(needed.size, physical.limits.allocation_bytes, "a buffer of this scene");
  const bool maps = physical.unified() || physical.maps,
             map = maps || placement != Placement::device;
  read_there_ =
      physical.unified() || placement == Placement::host || placement == Placement::staging;
  VkMemoryAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  info.allocationSize = needed.size;
  info.memoryTypeIndex =
      device_->memory_type(needed.memoryTypeBits, memory_wishes(placement, maps));
  device_->count_allocation();
  const std::string purpose = "allocating " + std::to_string(bytes_) + " bytes";
  counted_memory_ = true;
  check(vk.AllocateMemory(device_->handle(), &info, nullptr, &memory_), purpose.c_str());
  check(vk.BindBufferMemory(device_->handle(), handle_, memory_, 0), "vkBindBufferMemory");
  if (map && (device_->memory_flags(info.memoryTypeIndex) & kVisible) == kVisible) {
    check(vk.MapMemory(device_->handle(), memory_, 0, VK_WHOLE_SIZE, 0, &mapped_), "vkMapMemory");
  }
}

void Buffer::write_guards() {
  if (guard_ == 0) return;
  if (mapped_) {
    std::memset(mapped_, kSentinel, guard_);
    std::memset(begin() + bytes_, kSentinel, guard_);
    return;
  }
  const Buffer sentinels(*device_, guard_, Placement::host);
  std::memset(sentinels.begin(), kSentinel, guard_);
  for (const std::size_t at : {std::size_t{0}, guard_ + bytes_}) {
    copy(*device_, sentinels.handle_, sentinels.guard_, handle_, at, guard_);
  }
}

bool Buffer::guard_intact(std::size_t at) const {
  const auto intact = [&](const std::byte* from) {
    return std::all_of(from, from + guard_, [](std::byte b) { return b == std::byte{kSentinel}; });
  };
  if (mapped_) return intact(static_cast<const std::byte*>(mapped_) + at);
  const Buffer copied(*device_, guard_, Placement::host);
  copy(*device_, handle_, at, copied.handle_, copied.guard_, guard_);
  return intact(copied.begin());
}

void Buffer::check_guards() const noexcept {
  if (guard_ == 0 || !memory_) return;
  try {
    if (guard_intact(0) && guard_intact(guard_ + bytes_)) return;
    device_->report("a kernel wrote outside a buffer of " + std::to_string(bytes_) + " bytes");
  } catch (const DeviceError&) {
    return;  // of a lost device nothing can be read; what validation says is told already
  }
}

void Buffer::write(std::size_t offset, std::span<const std::byte> data) {
  if (data.empty()) return;
  if (mapped_) {
    std::memcpy(begin() + offset, data.data(), data.size());
    return;
  }
  device_->uploads().write(handle_, guard_ + offset, data);
}

void Buffer::read(std::size_t offset, std::span<std::byte> data) const {
  Part all;
  all.from = this;
  all.offset = offset;
  all.to = data;
  read_all({&all, 1});
}

void Buffer::read_all(std::span<const Part> parts) {
  for (const Part& part : parts) {
    if (part.to.empty()) continue;
    const Buffer& from = *part.from;
    from.device_->count_read(part.to.size());
    if (from.mapped_ && from.read_there_) {
      std::memcpy(part.to.data(), from.begin() + part.offset, part.to.size());
    } else {
      from.device_->uploads().want(from.handle_, from.guard_ + part.offset, part.to);
    }
  }
  for (const Part& part : parts) {
    if (!part.to.empty() && !(part.from->mapped_ && part.from->read_there_)) {
      part.from->device_->uploads().read();
      return;
    }
  }
}

void Buffer::fill_zero(std::size_t offset, std::size_t bytes) {
  if (bytes == 0) return;
  if (mapped_) {
    std::memset(begin() + offset, 0, bytes);
    return;
  }
  device_->uploads().fill_zero(handle_, guard_ + offset, bytes);
}

}  // namespace sunder::vulkan
