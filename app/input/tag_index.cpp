// SPDX-License-Identifier: Apache-2.0
#include "app/input/tag_index.hpp"

#include <algorithm>

namespace sunder::app {

TagIndex::TagIndex(std::span<const std::uint64_t> tags) {
  const std::uint64_t largest = tags.empty() ? 0 : *std::max_element(tags.begin(), tags.end());
  if (largest <= 4 * tags.size() + 1000) {
    table_.assign(largest + 1, -1);
    for (std::size_t i = 0; i < tags.size(); ++i) {
      if (table_[tags[i]] >= 0) duplicate_ = std::min(duplicate_.value_or(tags[i]), tags[i]);
      table_[tags[i]] = static_cast<std::int64_t>(i);
    }
    return;
  }
  sorted_.reserve(tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i) sorted_.emplace_back(tags[i], i);
  std::sort(sorted_.begin(), sorted_.end());
  const auto twice =
      std::adjacent_find(sorted_.begin(), sorted_.end(),
                         [](const auto& a, const auto& b) { return a.first == b.first; });
  if (twice != sorted_.end()) duplicate_ = twice->first;
}

std::optional<std::size_t> TagIndex::find(std::uint64_t tag) const {
  if (sorted_.empty()) {
    if (tag >= table_.size() || table_[tag] < 0) return std::nullopt;
    return static_cast<std::size_t>(table_[tag]);
  }
  const auto behind =
      std::upper_bound(sorted_.begin(), sorted_.end(), tag,
                       [](std::uint64_t value, const auto& entry) { return value < entry.first; });
  if (behind == sorted_.begin() || std::prev(behind)->first != tag) return std::nullopt;
  return std::prev(behind)->second;
}

}  // namespace sunder::app
