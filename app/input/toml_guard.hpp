// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace sunder::app {

/// Line (from 1) of the first character that is not ASCII and stands outside strings and comments,
/// where TOML 1.0 allows none. toml++ 3.3 runs into code it holds unreachable on some of them.
[[nodiscard]] std::optional<int> stray_character_line(std::string_view text);

}  // namespace sunder::app
