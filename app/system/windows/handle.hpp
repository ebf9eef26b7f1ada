// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <system_error>

#include "app/system/handle.hpp"
#include "machine/windows_api.hpp"

namespace sunder::app::system {

/// Why the last call of the system failed.
[[nodiscard]] inline std::error_code last_error() noexcept {
  return {static_cast<int>(GetLastError()), std::system_category()};
}

/// As it is kept in headers that do not know windows.h, and back.
[[nodiscard]] inline Handle kept(HANDLE handle) noexcept {
  return Handle(reinterpret_cast<std::intptr_t>(handle));
}
[[nodiscard]] inline HANDLE handle_of(std::intptr_t kept) noexcept {
  return reinterpret_cast<HANDLE>(kept);
}
[[nodiscard]] inline HANDLE handle_of(const Handle& kept) noexcept {
  return handle_of(kept.value());
}

/// What others may do with a file of ours meanwhile: read it, and take it away.
constexpr DWORD kShared = FILE_SHARE_READ | FILE_SHARE_DELETE;

/// A place in a file, as the calls that read, write and lock it take it.
[[nodiscard]] inline OVERLAPPED at(std::uint64_t position) noexcept {
  OVERLAPPED place{};
  place.Offset = static_cast<DWORD>(position & 0xffffffffU);
  place.OffsetHigh = static_cast<DWORD>(position >> 32U);
  return place;
}

}  // namespace sunder::app::system
