// SPDX-License-Identifier: Apache-2.0
// Reaction forces of the grips between frames: the compliance of the gripped unknowns answers at
// 1 kHz, on a thread of its own, while the next frame is computed.
#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include "sunder/types.hpp"

namespace sunder {

/// With L L^T the compliance C of the gripped unknowns G and u_0 their displacement without grips,
/// prescribed displacements d take the forces C^-1 (d - u_0).
///
/// One thread publishes, one other thread asks; neither ever waits for the other, and the asking
/// one sees a whole frame or the whole one before it (three copies, swapped by one atomic).
class InstrumentForces {
 public:
  /// `anchors`: stiffness [N/mm] of each gripped unknown's anchor, whose share is no reaction.
  explicit InstrumentForces(std::span<const double> anchors);

  /// Frame's side: a lower triangle L and u_0. Values that are not finite are not published.
  void publish(const Eigen::Ref<const Eigen::MatrixXd>& l,
               const Eigen::Ref<const Eigen::VectorXd>& u_0);
  /// Instruments' side: forces [N] on the body for displacements [mm] of the gripped unknowns, in
  /// the order of Problem::gripped_dofs(). Returns false, with zeros, before the first frame or
  /// for displacements that are not finite. Allocates nothing. Cost g^2 multiply-adds.
  bool forces(std::span<const double> displacements, std::span<double> forces);

  [[nodiscard]] Index size() const { return size_; }
  /// Frames published.
  [[nodiscard]] std::uint64_t frames() const { return frames_.load(std::memory_order_relaxed); }

 private:
  struct Copy {
    Eigen::MatrixXd l;
    Eigen::VectorXd u_0;
    bool filled = false;
  };
  static constexpr std::uint32_t kFresh = 4;

  Index size_;
  Eigen::VectorXd anchors_;
  std::array<Copy, 3> copies_;
  std::uint32_t writing_ = 0, reading_ = 1;  // each side's own copy
  std::atomic<std::uint32_t> between_{2};    // the third, with kFresh when it is news
  std::atomic<std::uint64_t> frames_{0};
};

}  // namespace sunder
