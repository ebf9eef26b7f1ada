// SPDX-License-Identifier: Apache-2.0
#include "app/inputs/words.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "app/input/nearest.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

template <class T>
bool parse_word(const std::string& text, T& value) {
  const char* begin = text.data() + (text.starts_with("+") ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(begin, end, value);
  return error == std::errc() && stopped == end;
}

}  // namespace

Words::Words(std::string place, std::string_view line) : place_(std::move(place)) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  for (std::size_t i = 0; i < line.size();) {
    if (is_blank(line[i])) {
      ++i;
    } else if (line[i] == '#') {
      break;
    } else if (line[i] == '"') {
      const std::size_t end = line.find('"', i + 1);
      if (end == std::string_view::npos) fail("a name in quotes has no end; close it with \"");
      words_.emplace_back(line.substr(i + 1, end - i - 1));
      i = end + 1;
    } else {
      std::size_t end = i;
      while (end < line.size() && !is_blank(line[end]) && line[end] != '#') ++end;
      words_.emplace_back(line.substr(i, end - i));
      i = end;
    }
  }
}

void Words::fail(const std::string& sentence) const {
  throw InputError(InputFault::out_of_range, place_ + sentence);
}

std::string Words::take(const std::string& what) {
  if (left() == 0) fail(what + " is missing");
  return words_[next_++];
}

double Words::number(const std::string& what) {
  const std::string text = take(what);
  double value = 0;
  if (!parse_word(text, value) || !std::isfinite(value)) {
    fail(what + " is " + in_quotes(text) + "; it takes a finite number");
  }
  return value;
}

int Words::whole(const std::string& what, int least) {
  const std::string text = take(what);
  int value = 0;
  if (!parse_word(text, value) || value < least) {
    fail(what + " is " + in_quotes(text) + "; it takes a whole number from " +
         std::to_string(least) + " to " + std::to_string(std::numeric_limits<int>::max()));
  }
  return value;
}

Vec3 Words::vector(const std::string& what) {
  Vec3 value;
  for (int axis = 0; axis < 3; ++axis) value[axis] = number(what + ", " + "xyz"[axis]);
  return value;
}

std::size_t Words::word(const std::string& what, const std::vector<std::string>& allowed) {
  const std::string text = take(what);
  const auto found = std::find(allowed.begin(), allowed.end(), text);
  if (found == allowed.end()) {
    fail(what + " is " + in_quotes(text) + "; allowed is " + quoted_list(allowed));
  }
  return static_cast<std::size_t>(found - allowed.begin());
}

void Words::end() {
  if (left() > 0) fail("what comes from " + in_quotes(words_[next_]) + " on is too much");
}

}  // namespace sunder::app
