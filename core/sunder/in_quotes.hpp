// SPDX-License-Identifier: Apache-2.0
// Text from outside (keys, names, words of a file) as messages show it.
#pragma once

#include <string>
#include <string_view>

namespace sunder {

/// `text` on one line: control characters (C0, DEL and, in UTF-8, C1) as \n, \t, \r or \u001b, so
/// that no name can end a message early, break its line or steer a terminal.
[[nodiscard]] std::string one_line(std::string_view text);

/// `"text"`: one line in quotes, cut with "..." behind `longest` bytes, never inside a character.
[[nodiscard]] std::string in_quotes(std::string_view text, std::size_t longest = 60);

}  // namespace sunder
