// SPDX-License-Identifier: Apache-2.0
// Stress of the intact body under the expansion instruments alone, smoothed over the breakable
// elements around a place (method.md "Model B"). Only the elements asked for are evaluated.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/in_plane_stress.hpp"
#include "sunder/problem.hpp"

namespace sunder::fracture {

class PristineField {
 public:
  /// `displacement` of the intact body, shape (3 * nodes), mm; must outlive the field.
  PristineField(const Problem& problem, const Board& board, std::span<const double> displacement)
      : problem_(problem), board_(board), displacement_(displacement) {
    near_.reserve(board.most_within(kNeighbourhood * board.h()));
  }
  /// From now on that of another displacement.
  void take(std::span<const double> displacement) { displacement_ = displacement; }

  /// Volume-weighted mean over breakable elements with centroids within 1.5 h of p; none when
  /// there is no such element.
  [[nodiscard]] std::optional<InPlane> at(const Vec2& p) const;

  /// Mean of at() over 9 stations between two points, empty neighbourhoods skipped; none when all
  /// are empty (method.md 5).
  [[nodiscard]] std::optional<InPlane> along(const Vec2& from, const Vec2& to) const;

 private:
  static constexpr double kNeighbourhood = 1.5;  // in h

  const Problem& problem_;
  const Board& board_;
  std::span<const double> displacement_;
  mutable std::vector<Index> near_;  // of the place being looked at
};

}  // namespace sunder::fracture
