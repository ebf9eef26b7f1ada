// SPDX-License-Identifier: Apache-2.0
// What the host writes to memory that it does not map, and reads of it, through one buffer that
// both reach: a write waits there for the next submit and goes before its commands, so that it
// costs neither a submit nor an allocation of its own.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gpu/vulkan/buffer.hpp"
#include "gpu/vulkan/commands.hpp"

namespace sunder::vulkan {

class Uploads {
 public:
  explicit Uploads(Device& device);

  /// Bytes of a buffer from the offset on, of which the next submit is the first to see. More than
  /// the room that is left is submitted at once, in pieces.
  void write(VkBuffer to, std::size_t offset, std::span<const std::byte> data);
  /// Likewise, zeros.
  void fill_zero(VkBuffer to, std::size_t offset, std::size_t bytes);
  /// The next read() brings these bytes.
  void want(VkBuffer from, std::size_t offset, std::span<std::byte> data);
  /// All that is wanted, by a submit of its own; by one for each roomful.
  void read();
  /// The buffer goes: what waits for it need not be copied.
  void forget(VkBuffer buffer) noexcept;

  /// What copies all that waits, for the front of a submit; null: nothing waits.
  [[nodiscard]] VkCommandBuffer record();
  /// That submit is done.
  void clear() noexcept;

 private:
  struct Copy {
    VkBuffer to;
    std::size_t offset, at, bytes;  // at: in the room; kZeros: zeros
  };
  struct Read {
    VkBuffer from;
    std::size_t offset;
    std::span<std::byte> to;
    std::size_t at;  // in the room
  };
  [[nodiscard]] std::size_t left() const;

  Device& device_;
  Buffer room_;
  std::size_t used_ = 0;
  std::vector<Copy> waiting_;
  std::vector<Read> wanted_;
  Commands copies_, reads_;
};

}  // namespace sunder::vulkan
