// SPDX-License-Identifier: Apache-2.0
#include "app/input/end_check.hpp"

#include "sunder/error.hpp"

namespace sunder::app {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view space = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(space);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(space) - begin + 1);
}

std::string_view last_line(std::string_view text) {
  text = trimmed(text);
  const std::size_t begin = text.rfind('\n');
  return trimmed(begin == std::string_view::npos ? text : text.substr(begin + 1));
}

// Lines that hold -1 alone open and close data sets, so there must be an even number of them.
bool data_sets_closed(std::string_view bytes) {
  bool open = false;
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    if (trimmed(bytes.substr(0, end)) == "-1") open = !open;
    bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
  }
  return !open;
}

[[noreturn]] void fail(const std::string& name, const std::string& mark) {
  throw InputError(InputFault::unreadable_file,
                   name + ": does not end with " + mark + ": the file is truncated");
}

}  // namespace

void check_end(std::string_view bytes, const std::string& extension, const std::string& name) {
  const std::string_view last = last_line(bytes);
  if (extension == ".mesh" && last != "End") fail(name, "\"End\"");
  if ((extension == ".bdf" || extension == ".nas") && !last.starts_with("ENDDATA"))
    fail(name, "\"ENDDATA\"");
  if (extension == ".unv" && (last != "-1" || !data_sets_closed(bytes)))
    fail(name, "the \"-1\" that closes a data set");
}

}  // namespace sunder::app
