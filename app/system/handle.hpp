// SPDX-License-Identifier: Apache-2.0
// A descriptor; on Windows a HANDLE, in headers that do not know windows.h.
#pragma once

#include <cstdint>
#include <utility>

namespace sunder::app::system {

/// What the system has open for us; closed with the object.
class Handle {
 public:
  /// None.
  Handle() = default;
  explicit Handle(std::intptr_t value) : value_(value) {}
  Handle(Handle&& other) noexcept : value_(std::exchange(other.value_, kNone)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(value_, other.value_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { close(); }

  [[nodiscard]] bool is_open() const noexcept { return value_ != kNone; }
  [[nodiscard]] std::intptr_t value() const noexcept { return value_; }
  /// False: what was written could not be kept. It is closed in any case.
  bool close() noexcept { return !is_open() || close(std::exchange(value_, kNone)); }

 private:
  static constexpr std::intptr_t kNone = -1;
  static bool close(std::intptr_t value) noexcept;

  std::intptr_t value_ = kNone;
};

}  // namespace sunder::app::system
