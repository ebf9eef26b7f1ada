// SPDX-License-Identifier: Apache-2.0
// Device memory as typed as it needs to be: a range of bytes that kernels read and write and the
// host fills and reads.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gpu/vulkan/device.hpp"

namespace sunder::vulkan {

/// Where a buffer lives. On unified memory all are mapped.
enum class Placement {
  device,   ///< device-local; the host goes through staging where it maps none of that
  host,     ///< the host's and mapped, for small things that it reads every frame
  sent,     ///< mapped, for what the host writes and never reads: the device's where it maps that
  staging,  ///< mapped, what others are written and read through; not counted among what is held
};

/// The kinds of memory of such a buffer, the best one first. `maps`: the host maps all of the
/// device's memory (PhysicalDevice::maps, or it is unified).
[[nodiscard]] std::span<const VkMemoryPropertyFlags> memory_wishes(Placement placement, bool maps);

class Buffer {
 public:
  Buffer() = default;
  /// Uninitialised memory; `bytes` at least 1. Throws DeviceError when the memory is not there.
  Buffer(Device& device, std::size_t bytes, Placement placement);
  /// A part of a host's buffer, which stays the host's. The host cannot read or write it from here.
  [[nodiscard]] static Buffer lent(VkBuffer buffer, std::size_t offset, std::size_t bytes);
  ~Buffer();
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;

  /// Bytes that a buffer for so many takes: whole texels.
  [[nodiscard]] static constexpr std::size_t padded(std::size_t bytes) {
    return (bytes == 0 ? 1 : bytes) / 16 * 16 + ((bytes == 0 ? 1 : bytes) % 16 > 0 ? 16 : 0);
  }
  [[nodiscard]] VkBuffer handle() const { return handle_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Where the bytes begin in the VkBuffer, and the range that kernels see.
  [[nodiscard]] std::size_t offset() const { return guard_; }
  [[nodiscard]] std::size_t range() const { return bytes_ + (device_ ? guard_ : 0); }

  /// Where it is not mapped, with the next submit.
  void write(std::size_t offset, std::span<const std::byte> data);
  void read(std::size_t offset, std::span<std::byte> data) const;
  /// Of a buffer from an offset on, and where it goes.
  struct Part {
    Part() = default;
    Part(const Buffer& buffer, std::size_t first, std::span<double> values)
        : from(&buffer), offset(first * sizeof(double)), to(std::as_writable_bytes(values)) {}
    const Buffer* from = nullptr;
    std::size_t offset = 0;
    std::span<std::byte> to;
  };
  /// Parts of buffers of one device, in one submit where they are not mapped.
  static void read_all(std::span<const Part> parts);
  void fill_zero() { fill_zero(0, bytes_); }
  /// Offset and bytes: multiples of 4.
  void fill_zero(std::size_t offset, std::size_t bytes);

  template <class T>
  void write(std::span<const T> values, std::size_t first = 0) {
    write(first * sizeof(T), std::as_bytes(values));
  }
  template <class T>
  void read(std::span<T> values, std::size_t first = 0) const {
    read(first * sizeof(T), std::as_writable_bytes(values));
  }
  /// The mapping; only of what is placed at the host or sent.
  template <class T>
  [[nodiscard]] T* mapped() const {
    return reinterpret_cast<T*>(begin());
  }

 private:
  [[nodiscard]] std::byte* begin() const { return static_cast<std::byte*>(mapped_) + guard_; }
  void create();
  void write_guards();
  [[nodiscard]] bool guard_intact(std::size_t at) const;
  void check_guards() const noexcept;
  void allocate(Placement placement);
  void release() noexcept;

  Device* device_ = nullptr;
  std::size_t bytes_ = 0, guard_ = 0;
  VkBuffer handle_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  void* mapped_ = nullptr;
  bool counted_ = false, counted_memory_ = false;
  bool read_there_ = false;  // by the host, which is slow where memory is the device's own
};

}  // namespace sunder::vulkan
