// SPDX-License-Identifier: Apache-2.0
#include "app/sweep/axes.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "app/output/text.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"

namespace sunder::app::sweep {
namespace {

constexpr const char* kAllowed =
    "allowed is KEY.PATH=A,B,C or KEY.PATH=LOW:HIGH:COUNT such as material.upper.yield=1:3:5";

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
  throw UsageError("--vary is " + in_quotes(text, 120) + ": " + why);
}

template <class T>
std::optional<T> parsed(std::string_view text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stopped != end) return {};
  return value;
}

/// Numbers from low to high; nothing: the text is no range.
std::optional<std::vector<std::string>> range(const std::string& text, std::string_view values) {
  const std::size_t first = values.find(':');
  if (first == std::string_view::npos) return {};
  const std::size_t second = values.find(':', first + 1);
  if (second == std::string_view::npos) return {};
  const auto low = parsed<double>(values.substr(0, first));
  const auto high = parsed<double>(values.substr(first + 1, second - first - 1));
  if (!low || !high) return {};
  const auto count = parsed<RunIndex>(values.substr(second + 1));
  if (!std::isfinite(*low) || !std::isfinite(*high)) refuse(text, "both ends have to be finite");
  if (!count || *count < 2 || *count > kMostRuns) {
    refuse(text, "the count after the second colon is a whole number from 2 to " +
                     std::to_string(kMostRuns));
  }
  std::vector<std::string> all;
  for (RunIndex i = 0; i < *count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(*count - 1);
    all.push_back(number(i + 1 == *count ? *high : *low + (*high - *low) * share));
  }
  return all;
}

std::string trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t";
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(kSpace) - begin + 1));
}

std::vector<std::string> list(const std::string& text, std::string_view values) {
  std::vector<std::string> all;
  int depth = 0;
  char quote = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const char c = values[i];
    if (quote) {
      if (c == '\\' && quote == '"')
        ++i;
      else if (c == quote)
        quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      if (--depth < 0) refuse(text, "a bracket closes that none has opened");
    } else if (c == ',' && depth == 0) {
      all.push_back(trimmed(values.substr(begin, i - begin)));
      begin = i + 1;
    }
  }
  if (quote) refuse(text, "a quote is not closed");
  if (depth > 0) refuse(text, "a bracket is not closed");
  all.push_back(trimmed(values.substr(begin)));
  return all;
}

/// Where the key ends: the first '=' outside quotes.
std::size_t end_of_key(const std::string& text) {
  char quote = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (quote) {
      if (text[i] == quote) quote = 0;
    } else if (text[i] == '"' || text[i] == '\'') {
      quote = text[i];
    } else if (text[i] == '=') {
      return i;
    }
  }
  return std::string::npos;
}

}  // namespace

Axis parse_axis(const std::string& text) {
  const std::size_t end = end_of_key(text);
  if (end == std::string::npos || end == 0) refuse(text, kAllowed);
  Axis axis;
  axis.key = text.substr(0, end);
  const std::string_view values = std::string_view(text).substr(end + 1);
  if (auto numbers = range(text, values)) {
    axis.values = std::move(*numbers);
  } else {
    axis.values = list(text, values);
  }
  for (const std::string& value : axis.values) {
    if (value.empty()) refuse(text, std::string("a value is empty; ") + kAllowed);
  }
  auto sorted = axis.values;
  std::ranges::sort(sorted);
  const auto twice = std::ranges::adjacent_find(sorted);
  if (twice != sorted.end()) refuse(text, "the value " + in_quotes(*twice) + " comes twice");
  return axis;
}

std::vector<Axis> parse_axes(const std::vector<std::string>& texts) {
  if (texts.empty()) throw UsageError(std::string("a sweep needs --vary; ") + kAllowed);
  std::vector<Axis> axes;
  for (const std::string& text : texts) {
    Axis axis = parse_axis(text);
    const bool twice = std::ranges::any_of(axes, [&](const Axis& a) { return a.key == axis.key; });
    if (twice) refuse(text, "the key " + in_quotes(axis.key) + " is varied twice");
    axes.push_back(std::move(axis));
  }
  double runs = 1;
  for (const Axis& axis : axes) runs *= static_cast<double>(axis.values.size());
  if (!(runs <= static_cast<double>(kMostRuns))) {
    throw UsageError("--vary makes " + rounded(runs, 3) + " runs; allowed are " +
                     grouped(kMostRuns));
  }
  return axes;
}

RunIndex run_count(const std::vector<Axis>& axes) {
  RunIndex runs = 1;
  for (const Axis& axis : axes) runs *= static_cast<RunIndex>(axis.values.size());
  return runs;
}

std::vector<std::size_t> places_of(const std::vector<Axis>& axes, RunIndex run) {
  std::vector<std::size_t> places(axes.size());
  for (std::size_t a = axes.size(); a-- > 0;) {
    const auto count = static_cast<RunIndex>(axes[a].values.size());
    places[a] = static_cast<std::size_t>(run % count);
    run /= count;
  }
  return places;
}

std::vector<std::string> values_of(const std::vector<Axis>& axes, RunIndex run) {
  const std::vector<std::size_t> places = places_of(axes, run);
  std::vector<std::string> values;
  for (std::size_t a = 0; a < axes.size(); ++a) values.push_back(axes[a].values[places[a]]);
  return values;
}

std::vector<std::string> overrides_at(const std::vector<Axis>& axes,
                                      const std::vector<std::size_t>& places) {
  std::vector<std::string> all;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    all.push_back(axes[a].key + "=" + axes[a].values[places[a]]);
  }
  return all;
}

}  // namespace sunder::app::sweep
