// SPDX-License-Identifier: Apache-2.0
// Values from one thread to one other, neither of which ever waits: the reading one has the last
// that was handed over, whole, and as many of those before it as it keeps.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace sunder {

/// One copy is written, `Kept` are read, and one lies between them, exchanged by one atomic. What
/// a copy holds is overwritten only by the writing thread, so its memory is used again.
template <class T, std::size_t Kept = 1>
class Handover {
 public:
  Handover() {
    for (std::uint32_t i = 0; i < Kept; ++i) reading_[i] = i + 2;
  }

  /// Writing side: what the next hand_over() gives.
  [[nodiscard]] T& next() { return copies_[writing_]; }
  void hand_over() {
    writing_ = between_.exchange(writing_ | kFresh, std::memory_order_acq_rel) & ~kFresh;
  }

  /// Reading side: whether something has been handed over since the last take().
  [[nodiscard]] bool news() const { return between_.load(std::memory_order_relaxed) & kFresh; }
  /// After news(): the last one becomes read(0), what was becomes read(1), and so on.
  void take() {
    const std::uint32_t oldest = reading_[Kept - 1];
    const std::uint32_t got = between_.exchange(oldest, std::memory_order_acq_rel) & ~kFresh;
    for (std::size_t i = Kept - 1; i > 0; --i) reading_[i] = reading_[i - 1];
    reading_[0] = got;
  }
  [[nodiscard]] T& read(std::size_t before = 0) { return copies_[reading_[before]]; }

  /// All copies, before any thread uses them.
  [[nodiscard]] std::array<T, Kept + 2>& copies() { return copies_; }

 private:
  static constexpr std::uint32_t kFresh = 1U << 16;

  std::array<T, Kept + 2> copies_{};
  std::uint32_t writing_ = 0;                // the writing side's own
  std::array<std::uint32_t, Kept> reading_;  // the reading side's own
  std::atomic<std::uint32_t> between_{1};
};

}  // namespace sunder
