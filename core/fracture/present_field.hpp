// SPDX-License-Identifier: Apache-2.0
// Stress of the body as it is now, damaged and under all instruments, smoothed over the live
// destructible elements around a place (method.md 5, sigma0 = "present"). Only the displacements of
// the elements asked for are read.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/patch_changes.hpp"
#include "fracture/remote_field.hpp"
#include "sunder/problem.hpp"

namespace sunder::fracture {

class PresentField final : public RemoteField {
 public:
  using ReadDisplacement = std::function<void(std::span<const Index>, std::span<Vec3>)>;

  PresentField(const Problem& problem, const Board& board);
  /// From now on that of this state. `destroyed` (per element), `displacement` (of some nodes, mm)
  /// and `pools`, as FractureState has them, must outlive its use.
  void take(std::span<const std::uint8_t> destroyed, const ReadDisplacement& displacement,
            const fem::Pools* pools = nullptr) {
    destroyed_ = destroyed;
    pools_ = pools;
    displacement_ = &displacement;
  }

  /// Over the live destructible elements.
  [[nodiscard]] std::optional<InPlane> at(const Vec2& p) const override;

 private:
  const Problem& problem_;
  const Board& board_;
  std::span<const std::uint8_t> destroyed_;
  const ReadDisplacement* displacement_ = nullptr;
  const fem::Pools* pools_ = nullptr;
  // Of the place being looked at: its elements, their corners, the corners' displacements.
  mutable std::vector<Index> near_, corners_;
  mutable std::vector<Vec3> moved_;
  mutable PatchChanges patches_;
};

}  // namespace sunder::fracture
