// SPDX-License-Identifier: Apache-2.0
// Tag of a mesh file -> position in the file.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace sunder::app {

class TagIndex {
 public:
  explicit TagIndex(std::span<const std::uint64_t> tags);

  /// Position of the (last) occurrence; nullopt when there is none.
  [[nodiscard]] std::optional<std::size_t> find(std::uint64_t tag) const;
  /// A tag that occurs twice, the smallest.
  [[nodiscard]] std::optional<std::uint64_t> duplicate() const { return duplicate_; }

 private:
  // Tags are usually 1 ... n: a table; otherwise pairs (tag, position), sorted.
  std::vector<std::int64_t> table_;
  std::vector<std::pair<std::uint64_t, std::size_t>> sorted_;
  std::optional<std::uint64_t> duplicate_;
};

}  // namespace sunder::app
