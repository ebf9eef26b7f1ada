// SPDX-License-Identifier: Apache-2.0
// What the host reads of a state once it is there comes along in the submit that computes it, where
// the host does not read the device's memory itself.
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "gpu/vulkan/buffer.hpp"
#include "gpu/vulkan/commands.hpp"

namespace sunder::gpu {

class ReadAlong {
 public:
  enum class What { nothing, displacement, residual };

  ReadAlong() = default;
  /// For fields of so many bytes.
  ReadAlong(vulkan::Device& device, std::size_t bytes) {
    if (planned_bytes(device.physical(), bytes) == 0) return;
    buffer_.emplace(device, bytes, vulkan::Placement::host);
  }

  /// Bytes of that, before it exists.
  [[nodiscard]] static std::size_t planned_bytes(const vulkan::PhysicalDevice& device,
                                                 std::size_t bytes) {
    return device.unified() ? 0 : vulkan::Buffer::padded(bytes);
  }
  [[nodiscard]] std::size_t bytes() const { return buffer_ ? buffer_->bytes() : 0; }

  /// What the states bring from the next one on.
  void ask(What what) { asked_ = buffer_ ? what : What::nothing; }
  [[nodiscard]] What asked() const { return asked_; }

  /// At the end of what computes a state.
  void record(vulkan::Commands& commands, const vulkan::Buffer& displacement,
              const vulkan::Buffer& residual) {
    again();
    if (asked_ == What::nothing) return;
    const vulkan::Buffer& from = asked_ == What::displacement ? displacement : residual;
    commands.copy(from.handle(), from.offset(), buffer_->handle(), buffer_->offset(),
                  std::min(from.bytes(), buffer_->bytes()));
  }
  /// The state that was recorded for what is asked() is submitted once more.
  void again() { came_ = asked_; }

  /// Where it has come with the last state; `there` otherwise.
  [[nodiscard]] const vulkan::Buffer& where(What what, const vulkan::Buffer& there) const {
    return what == came_ && what != What::nothing ? *buffer_ : there;
  }

 private:
  std::optional<vulkan::Buffer> buffer_;
  What asked_ = What::nothing, came_ = What::nothing;
};

}  // namespace sunder::gpu
