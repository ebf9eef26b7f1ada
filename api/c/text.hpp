// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "c/failure.hpp"

namespace sunder::c {

/// Text into a caller's buffer; a text that does not fit is cut. Throws SUNDER_ERROR_NULL for a
/// null buffer with a capacity.
inline void write_text(const std::string& text, char* to, std::size_t capacity,
                       std::size_t* length) {
  if (capacity > 0) {
    require(to, "the text buffer");
    const std::size_t count = std::min(text.size(), capacity - 1);
    text.copy(to, count);
    to[count] = '\0';
  }
  if (length) *length = text.size();
}

template <std::size_t N>
void write_text(const std::string& text, char (&to)[N]) {
  write_text(text, to, N, nullptr);
}

}  // namespace sunder::c
