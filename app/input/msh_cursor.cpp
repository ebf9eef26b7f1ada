// SPDX-License-Identifier: Apache-2.0
#include "app/input/msh_cursor.hpp"

#include <charconv>
#include <cmath>
#include <limits>

#include "sunder/in_quotes.hpp"

namespace sunder::app {
namespace {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

std::string shown(std::string_view word) { return in_quotes(word, 40); }

}  // namespace

std::string MshCursor::where() const {
  std::string text = name_;
  // Behind a binary body, lines mean nothing to a reader.
  if (!binary_) text += ":" + std::to_string(line_);
  if (!section_.empty()) text += ": in section " + section_;
  return text;
}

void MshCursor::fail(const std::string& message, InputFault fault) const {
  throw InputError(fault, where() + ": " + message);
}

void MshCursor::fail_truncated(const char* what) const {
  fail(std::string("the file ends where ") + what + " should be: it is truncated");
}

void MshCursor::skip_space() {
  while (position_ < bytes_.size() && is_space(bytes_[position_])) {
    if (bytes_[position_] == '\n') ++line_;
    ++position_;
  }
}

void MshCursor::skip_rest_of_line() { static_cast<void>(line()); }

std::string_view MshCursor::word() {
  skip_space();
  const std::size_t begin = position_;
  while (position_ < bytes_.size() && !is_space(bytes_[position_])) ++position_;
  return bytes_.substr(begin, position_ - begin);
}

std::string_view MshCursor::line() {
  const std::size_t begin = position_;
  const std::size_t end = std::min(bytes_.find('\n', begin), bytes_.size());
  position_ = std::min(end + 1, bytes_.size());
  if (end < bytes_.size()) ++line_;
  std::string_view text = bytes_.substr(begin, end - begin);
  if (text.ends_with('\r')) text.remove_suffix(1);
  return text;
}

bool MshCursor::skip_past_line(std::string_view mark) {
  while (!at_end()) {
    if (line().starts_with(mark)) return true;
  }
  return false;
}

std::string_view MshCursor::number_word(const char* what) {
  std::string_view text = word();
  if (text.empty()) fail_truncated(what);
  if (text.size() > 1 && text.front() == '+') text.remove_prefix(1);  // not known to from_chars
  return text;
}

std::int64_t MshCursor::text_integer(const char* what) {
  const std::string_view text = number_word(what);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range)
    fail(std::string(what) + " is " + shown(text) + ", too large a number", InputFault::bad_id);
  if (error != std::errc() || end != text.data() + text.size())
    fail(std::string("expected ") + what + " (an integer), found " + shown(text));
  return value;
}

double MshCursor::text_real(const char* what) {
  const std::string_view text = number_word(what);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  // Too small for a double is 0, as fscanf has it; too large is not finite.
  if (error == std::errc::result_out_of_range) {
    if (text.find("e-") != std::string_view::npos || text.find("E-") != std::string_view::npos)
      return 0;
    value = std::numeric_limits<double>::infinity();
  } else if (error != std::errc() || end != text.data() + text.size()) {
    fail(std::string("expected ") + what + " (a number), found " + shown(text));
  }
  if (!std::isfinite(value))
    fail(std::string(what) + " is " + shown(text) + "; allowed: finite numbers",
         InputFault::out_of_range);
  return value;
}

int MshCursor::int32(const char* what) {
  if (binary_) return raw<std::int32_t>(what);
  const std::int64_t value = text_integer(what);
  if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max())
    fail(std::string(what) + " is " + std::to_string(value) + ", too large a number",
         InputFault::bad_id);
  return static_cast<int>(value);
}

std::uint64_t MshCursor::size(const char* what) {
  if (binary_) return raw<std::uint64_t>(what);
  const std::int64_t value = text_integer(what);
  if (value < 0)
    fail(std::string(what) + " is " + std::to_string(value) + "; allowed: 0 or more",
         InputFault::bad_id);
  return static_cast<std::uint64_t>(value);
}

double MshCursor::real(const char* what) {
  if (!binary_) return text_real(what);
  const double value = raw<double>(what);
  if (!std::isfinite(value))
    fail(std::string(what) + " is not finite; allowed: finite numbers", InputFault::out_of_range);
  return value;
}

std::uint64_t MshCursor::check_count(std::int64_t count, std::size_t bytes_each,
                                     const char* what) const {
  const std::size_t each = binary_ ? bytes_each : 2;
  if (count < 0 || static_cast<std::uint64_t>(count) > remaining() / each + 1)
    fail("declares " + std::to_string(count) + " " + what + ", more than the rest of the file " +
         "can hold: the count is wrong or the file is truncated");
  return static_cast<std::uint64_t>(count);
}

void MshCursor::begin_binary_body() {
  if (!binary_) return;
  skip_rest_of_line();
}

}  // namespace sunder::app
