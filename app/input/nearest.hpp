// SPDX-License-Identifier: Apache-2.0
// "Did you mean ...": the known word nearest to a mistyped one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sunder::app {

/// The word with the fewest edits to `word` (ties: the first), or "" when none is close.
[[nodiscard]] std::string nearest(std::string_view word, const std::vector<std::string>& known);

/// `"a", "b" or "c"`.
[[nodiscard]] std::string quoted_list(const std::vector<std::string>& words,
                                      std::string_view last = "or");

}  // namespace sunder::app
