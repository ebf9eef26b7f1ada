// SPDX-License-Identifier: Apache-2.0
// Reads the tokens (ascii) or the words (binary) of a .msh file and knows where it stands.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "sunder/error.hpp"

namespace sunder::app {

class MshCursor {
 public:
  MshCursor(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  void set_binary(bool binary) { binary_ = binary; }
  void set_swapped(bool swapped) { swapped_ = swapped; }
  void set_section(std::string section) { section_ = std::move(section); }
  [[nodiscard]] bool binary() const { return binary_; }

  [[nodiscard]] bool at_end() const { return position_ >= bytes_.size(); }
  [[nodiscard]] std::size_t remaining() const { return bytes_.size() - position_; }

  void skip_space();
  void skip_rest_of_line();
  /// The next word between white space; "" at the end of the file.
  [[nodiscard]] std::string_view word();
  /// The rest of the line, without its end.
  [[nodiscard]] std::string_view line();
  /// Moves behind the next line that begins with `mark`; false when there is none.
  [[nodiscard]] bool skip_past_line(std::string_view mark);

  // Text numbers.
  [[nodiscard]] std::int64_t text_integer(const char* what);
  [[nodiscard]] double text_real(const char* what);

  // Numbers of the body: text or binary, as the file is.
  [[nodiscard]] int int32(const char* what);
  [[nodiscard]] std::uint64_t size(const char* what);
  [[nodiscard]] double real(const char* what);
  /// A count of things that take at least `bytes_each` bytes of what is left (2 in text).
  [[nodiscard]] std::uint64_t check_count(std::int64_t count, std::size_t bytes_each,
                                          const char* what) const;
  /// A binary body begins right after the line's end.
  void begin_binary_body();

  [[nodiscard]] std::string where() const;
  [[noreturn]] void fail(const std::string& message,
                         InputFault fault = InputFault::unreadable_file) const;

  /// One binary number.
  template <class Word>
  [[nodiscard]] Word raw(const char* what) {
    if (remaining() < sizeof(Word)) fail_truncated(what);
    char buffer[sizeof(Word)];
    std::memcpy(buffer, bytes_.data() + position_, sizeof(Word));
    if (swapped_) {
      for (std::size_t i = 0; i < sizeof(Word) / 2; ++i)
        std::swap(buffer[i], buffer[sizeof(Word) - 1 - i]);
    }
    position_ += sizeof(Word);
    Word value;
    std::memcpy(&value, buffer, sizeof(Word));
    return value;
  }

 private:
  [[noreturn]] void fail_truncated(const char* what) const;
  [[nodiscard]] std::string_view number_word(const char* what);

  std::string_view bytes_;
  std::string name_;
  std::string section_;
  std::size_t position_ = 0;
  std::size_t line_ = 1;
  bool binary_ = false;
  bool swapped_ = false;
};

}  // namespace sunder::app
