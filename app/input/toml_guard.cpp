// SPDX-License-Identifier: Apache-2.0
#include "app/input/toml_guard.hpp"

#include <algorithm>
#include <cstddef>
#include <string>

namespace sunder::app {
namespace {

// Position behind the string that begins at `begin` with one quote or three.
std::size_t behind_string(std::string_view text, std::size_t begin) {
  const char quote = text[begin];
  const std::string three(3, quote);
  const bool multiline = text.substr(begin, 3) == three;
  std::size_t i = begin + (multiline ? 3 : 1);
  while (i < text.size()) {
    if (quote == '"' && text[i] == '\\') {
      i += 2;
    } else if (multiline && text.substr(i, 3) == three) {
      return i + 3;
    } else if (!multiline && (text[i] == quote || text[i] == '\n')) {
      return i + 1;  // a line's end in it is toml++'s to refuse
    } else {
      ++i;
    }
  }
  return text.size();
}

}  // namespace

std::optional<int> stray_character_line(std::string_view text) {
  std::size_t i = text.starts_with("\xef\xbb\xbf") ? 3 : 0;  // byte order mark
  while (i < text.size()) {
    const char c = text[i];
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
    } else if (c == '"' || c == '\'') {
      i = behind_string(text, i);
    } else if (static_cast<unsigned char>(c) >= 0x80) {
      int line = 1;
      for (const char before : text.substr(0, i)) line += before == '\n' ? 1 : 0;
      return line;
    } else {
      ++i;
    }
  }
  return std::nullopt;
}

}  // namespace sunder::app
