// SPDX-License-Identifier: Apache-2.0
// Fields of the last finished frame, for another thread while the next one is computed.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "sunder/handover.hpp"
#include "sunder/types.hpp"

namespace sunder {

/// What a reader wants of each frame; what it does not want costs nothing.
struct FinishedFields {
  bool displacement = false, stress = false, yield_ratio = false, destroyed = false;
  /// Nodes whose displacement it wants, those that split cracks bring never among them; empty: all
  /// of the body. On route condensed a few cost what they are, all of them a solve.
  std::vector<Index> nodes;
};

/// Before the first step zeros.
struct FinishedFrame {
  std::uint64_t number = 0;             ///< another one where something may have changed; from 1 on
  int step = kNone;                     ///< that it is the end of; kNone: before the first one
  Index node_count = 0;                 ///< of the body
  std::vector<Vec3> displacement;       ///< of the wanted nodes, or of all of the body's [mm]
  std::vector<Voigt> stress;            ///< per element [MPa]
  std::vector<double> yield_ratio;      ///< per element, 0 where it cannot break
  std::vector<std::uint8_t> destroyed;  ///< per element
};

/// One thread steps, one other thread reads; neither ever waits for the other.
class FinishedFrames {
 public:
  explicit FinishedFrames(FinishedFields fields) : fields_(std::move(fields)) {}

  [[nodiscard]] const FinishedFields& fields() const { return fields_; }
  /// Stepping side: fill, then hand over.
  [[nodiscard]] FinishedFrame& next() { return handover_.next(); }
  void hand_over() {
    handover_.next().number = ++number_;
    handover_.hand_over();
  }
  /// From any thread: no frame comes any more.
  void end() { gone_.store(true, std::memory_order_release); }

  /// Reading side: the last finished frame, the caller's until its next call.
  [[nodiscard]] const FinishedFrame& take() {
    if (handover_.news()) handover_.take();
    return handover_.read();
  }
  [[nodiscard]] bool gone() const { return gone_.load(std::memory_order_acquire); }

 private:
  FinishedFields fields_;
  Handover<FinishedFrame> handover_;
  std::uint64_t number_ = 0;  // the stepping side's own
  std::atomic<bool> gone_{false};
};

}  // namespace sunder
