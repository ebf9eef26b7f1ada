// SPDX-License-Identifier: Apache-2.0
// Numbers and strings as the result files write them.
#pragma once

#include <string>
#include <string_view>

namespace sunder::app {

/// Shortest decimal that reads back as the same double.
[[nodiscard]] std::string number(double value);

/// At most `digits` significant digits, trailing zeros dropped: for pictures and people.
[[nodiscard]] std::string rounded(double value, int digits);

/// 1234567 -> "1,234,567".
[[nodiscard]] std::string grouped(long long value);

/// Bytes with a binary unit: "3.7 MiB".
[[nodiscard]] std::string byte_size(double bytes);

/// "1 element", "2 elements"; `many` where the plural is another word.
[[nodiscard]] std::string counted(long long count, std::string_view noun,
                                  std::string_view many = {});

/// Escapes text for XML and HTML, element content and attribute values alike; bytes that XML
/// cannot hold become spaces.
[[nodiscard]] std::string escaped(std::string_view text);

[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace sunder::app
