// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace sunder::app::system {

/// A file's name out of UTF-8, which command lines and scenes are in. On Windows a plain conversion
/// from std::string would take it for a code page's; `.string()` gives UTF-8 back.
[[nodiscard]] inline std::filesystem::path utf8_path(std::string_view name) {
  return {std::u8string(name.begin(), name.end())};
}

}  // namespace sunder::app::system
