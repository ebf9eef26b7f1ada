// SPDX-License-Identifier: Apache-2.0
// Numbers, counts and places as messages show them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sunder/types.hpp"

namespace sunder {

/// Shortest decimal that reads back as the same double, so that no message rounds a wrong value to
/// a right one; "not a number", "infinity", "-infinity".
[[nodiscard]] std::string in_digits(double value);

/// "1 node", "2 nodes"; `many` where the plural is another word.
[[nodiscard]] std::string count_of(long long count, std::string_view one,
                                   std::string_view many = {});

/// One line, cut with "..." behind `longest` bytes, never inside a character.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t longest);

/// The first names in quotes and how many more there are: `"a", "b" and 92 more`.
[[nodiscard]] std::string name_list(const std::vector<std::string>& names);

/// "[1, 2.5, -3]", at most six digits each: a place to look at.
[[nodiscard]] std::string place(const Vec3& x);

}  // namespace sunder
