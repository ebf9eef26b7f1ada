// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace sunder::c {

inline constexpr std::size_t kErrorText = 1024;  ///< bytes of an error text with its zero

[[nodiscard]] const char* last_text_of_thread() noexcept;

}  // namespace sunder::c
