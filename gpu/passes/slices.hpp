// SPDX-License-Identifier: Apache-2.0
// Where the entries of rows of unequal length stand: slices of 64 rows, each as wide as its longest
// (SELL-64), so that the invocations of a workgroup read side by side.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "gpu/kernels.hpp"

namespace sunder::gpu {

class Slices {
 public:
  Slices() = default;
  /// Of rows with so many entries each; no slice is narrower than 1.
  explicit Slices(std::span<const std::size_t> lengths)
      : first_(round_up(static_cast<std::uint32_t>(lengths.size()), shaders::kGroup) /
                       shaders::kGroup +
                   1,
               0) {
    for (std::uint32_t slice = 0; slice < groups(); ++slice) {
      const std::size_t begin = std::size_t{slice} * shaders::kGroup,
                        size = std::min<std::size_t>(shaders::kGroup, lengths.size() - begin),
                        width = std::ranges::max(lengths.subspan(begin, size));
      first_[slice + 1] = first_[slice] + std::max(static_cast<std::uint32_t>(width), 1U);
    }
  }

  /// Workgroups of 64 rows.
  [[nodiscard]] std::uint32_t groups() const {
    return static_cast<std::uint32_t>(first_.size() - 1);
  }
  /// Entries, those that pad included.
  [[nodiscard]] std::size_t count() const { return std::size_t{first_.back()} * shaders::kGroup; }
  /// Of a row's k-th entry.
  [[nodiscard]] std::size_t place(std::size_t row, std::size_t k) const {
    return (first_[row / shaders::kGroup] + k) * shaders::kGroup + row % shaders::kGroup;
  }
  /// Entries of each row of a slice.
  [[nodiscard]] std::uint32_t width(std::uint32_t slice) const {
    return first_[slice + 1] - first_[slice];
  }
  /// First entry of each slice, / 64; the last is behind all. For kernels.
  [[nodiscard]] const std::vector<std::uint32_t>& first() const { return first_; }
  [[nodiscard]] std::size_t bytes() const { return first_.size() * sizeof(std::uint32_t); }

 private:
  std::vector<std::uint32_t> first_{0};
};

/// Slices of which a part is in reserve, and is read only while somebody uses it.
class ReservedSlices {
 public:
  ReservedSlices() = default;
  /// `width`: what is always read of the rows of a slice.
  ReservedSlices(Slices slices, const std::function<std::uint32_t(std::uint32_t slice)>& width)
      : slices_(std::move(slices)), users_(slices_.groups(), 0) {
    for (std::uint32_t s = 0; s < slices_.groups(); ++s) {
      width_.push_back(width(s));
      const std::uint32_t first = slices_.first()[s];
      ranges_.insert(ranges_.end(), {first, first + width_.back()});
    }
  }

  [[nodiscard]] const Slices& slices() const { return slices_; }
  /// Of a row's k-th entry in reserve.
  [[nodiscard]] std::size_t place_in_reserve(std::size_t row, std::size_t k) const {
    return slices_.place(row, width_[row / shaders::kGroup] + k);
  }
  /// One more (1) or less (-1) uses the reserve of a row's slice.
  void use(std::size_t row, int one) {
    const std::size_t s = row / shaders::kGroup;
    users_[s] += one;
    const std::uint32_t first = slices_.first()[s];
    ranges_[2 * s + 1] = users_[s] > 0 ? slices_.first()[s + 1] : first + width_[s];
  }
  /// First entry and the one behind the last of each slice, / 64. For kernels.
  [[nodiscard]] const std::vector<std::uint32_t>& ranges() const { return ranges_; }

 private:
  Slices slices_;
  std::vector<int> users_;
  std::vector<std::uint32_t> width_, ranges_;
};

}  // namespace sunder::gpu
