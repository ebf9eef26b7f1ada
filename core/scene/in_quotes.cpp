// SPDX-License-Identifier: Apache-2.0
#include "sunder/in_quotes.hpp"

namespace sunder {
namespace {

std::string escape(unsigned char c) {
  switch (c) {
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    case '\t':
      return "\\t";
    default: {
      constexpr const char* digits = "0123456789abcdef";
      return std::string("\\u00") + digits[c >> 4U] + digits[c & 15U];
    }
  }
}

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xc0U) == 0x80U; }  // UTF-8

}  // namespace

std::string one_line(std::string_view text) {
  std::string line;
  line.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    if (c < 0x20 || c == 0x7f) {
      line += escape(c);
    } else if (c == 0xc2 && next >= 0x80 && next <= 0x9f) {
      line += escape(next);  // C1: U+0080 to U+009F
      ++i;
    } else {
      line += text[i];
    }
  }
  return line;
}

std::string in_quotes(std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return '"' + one_line(text) + '"';
  while (longest > 0 && continues(text[longest])) --longest;
  return '"' + one_line(text.substr(0, longest)) + "...\"";
}

}  // namespace sunder
