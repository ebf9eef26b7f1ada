// SPDX-License-Identifier: Apache-2.0
// One line of inputs as words, each read as what is expected there or refused in one sentence.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::app {

class Words {
 public:
  /// `place` ("file:line: ") begins messages. A word in double quotes may hold blanks; what follows
  /// a # is a comment. Throws InputError for a quote without an end.
  Words(std::string place, std::string_view line);

  [[nodiscard]] bool empty() const { return words_.empty(); }
  /// Of words that have not been taken.
  [[nodiscard]] std::size_t left() const { return words_.size() - next_; }
  /// The next one as it stands, an empty word where there is none.
  [[nodiscard]] std::string peek() const { return left() ? words_[next_] : std::string(); }

  /// The next one; `what` says what is missing where there is none.
  std::string take(const std::string& what);
  /// Finite. "x of drive" says where.
  double number(const std::string& what);
  int whole(const std::string& what, int least);
  Vec3 vector(const std::string& what);
  /// The place among `allowed`.
  std::size_t word(const std::string& what, const std::vector<std::string>& allowed);
  /// Throws where words are left.
  void end();

  [[noreturn]] void fail(const std::string& sentence) const;

 private:
  std::string place_;
  std::vector<std::string> words_;
  std::size_t next_ = 0;
};

}  // namespace sunder::app
