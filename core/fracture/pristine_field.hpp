// SPDX-License-Identifier: Apache-2.0
// Stress of the intact body under the expansion instruments alone, smoothed over the breakable
// elements around a place (method.md "Model B"). Only the elements asked for are evaluated.
#pragma once

#include <optional>
#include <span>

#include "fracture/board.hpp"
#include "fracture/in_plane_stress.hpp"
#include "sunder/problem.hpp"

namespace sunder::fracture {

class PristineField {
 public:
  /// `displacement` of the intact body, shape (3 * nodes), mm; must outlive the field.
  PristineField(const Problem& problem, const Board& board, std::span<const double> displacement)
      : problem_(problem), board_(board), displacement_(displacement) {}

  /// Volume-weighted mean over breakable elements with centroids within 1.5 h of p; none when
  /// there is no such element.
  [[nodiscard]] std::optional<InPlane> at(const Vec2& p) const;

  /// Mean of at() over 9 stations between two points, empty neighbourhoods skipped; none when all
  /// are empty (method.md 5).
  [[nodiscard]] std::optional<InPlane> along(const Vec2& from, const Vec2& to) const;

 private:
  const Problem& problem_;
  const Board& board_;
  std::span<const double> displacement_;
};

}  // namespace sunder::fracture
