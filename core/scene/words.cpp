// SPDX-License-Identifier: Apache-2.0
#include "sunder/words.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "sunder/in_quotes.hpp"

namespace sunder {

std::string in_digits(double value) {
  if (std::isnan(value)) return "not a number";
  if (std::isinf(value)) return value > 0 ? "infinity" : "-infinity";
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string count_of(long long count, std::string_view one, std::string_view many) {
  std::string text = std::to_string(count) + " ";
  if (count == 1) return text.append(one);
  return many.empty() ? text.append(one).append("s") : text.append(many);
}

std::string shortened(std::string_view text, std::size_t longest) {
  const std::string quoted = in_quotes(text, longest);
  return quoted.substr(1, quoted.size() - 2);
}

std::string name_list(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kShown); ++i)
    text.append(i > 0 ? ", " : "").append(in_quotes(names[i]));
  if (names.size() > kShown) text += " and " + std::to_string(names.size() - kShown) + " more";
  return text;
}

std::string place(const Vec3& x) {
  std::string text = "[";
  for (int axis = 0; axis < 3; ++axis) {
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), x[axis],
                                   std::chars_format::general, 6)
                         .ptr;
    text.append(axis > 0 ? ", " : "").append(buffer.data(), end);
  }
  return text + "]";
}

}  // namespace sunder
