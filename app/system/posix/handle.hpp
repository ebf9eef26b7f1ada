// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <system_error>

#include "app/system/handle.hpp"

namespace sunder::app::system {

/// Why the last call of the system failed.
[[nodiscard]] inline std::error_code last_error() noexcept {
  return {errno, std::generic_category()};
}

[[nodiscard]] inline int descriptor(const Handle& handle) noexcept {
  return static_cast<int>(handle.value());
}

}  // namespace sunder::app::system
