// SPDX-License-Identifier: Apache-2.0
#include "app/cli/values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "app/input/nearest.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& value,
                         const std::string& allowed) {
  throw UsageError(option + " is " + in_quotes(value) + "; allowed is " + allowed);
}

template <class T>
bool parse(const std::string& text, T& value) {
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stopped == end;
}

}  // namespace

void check_word(const std::string& option, const std::string& value,
                const std::vector<std::string>& allowed) {
  if (std::find(allowed.begin(), allowed.end(), value) == allowed.end())
    refuse(option, value, quoted_list(allowed));
}

int whole_number(const std::string& option, const std::string& value, int least) {
  int number = 0;
  if (!parse(value, number) || number < least)
    refuse(option, value, "a whole number from " + std::to_string(least) + " to 2147483647");
  return number;
}

std::vector<int> number_list(const std::string& option, const std::string& value) {
  std::vector<int> numbers;
  for (std::size_t begin = 0; begin <= value.size();) {
    const std::size_t end = std::min(value.find(',', begin), value.size());
    int number = 0;
    if (!parse(value.substr(begin, end - begin), number) || number < 1)
      refuse(option, value, "a list of whole numbers above 0 such as 5,10,20");
    numbers.push_back(number);
    begin = end + 1;
  }
  return numbers;
}

double positive_number(const std::string& option, const std::string& value) {
  double number = 0;
  if (!parse(value, number) || !std::isfinite(number) || !(number > 0))
    refuse(option, value, "a finite number above 0");
  return number;
}

}  // namespace sunder::app
