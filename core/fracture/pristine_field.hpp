// SPDX-License-Identifier: Apache-2.0
// Stress of the intact body under the expansion instruments alone, smoothed over the destructible
// elements around a place (method.md "Model B"). Only the elements asked for are evaluated.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/patch_changes.hpp"
#include "fracture/remote_field.hpp"
#include "sunder/problem.hpp"

namespace sunder::fracture {

class PristineField final : public RemoteField {
 public:
  /// `displacement` of the intact body, shape (3 * nodes), mm; must outlive the field.
  PristineField(const Problem& problem, const Board& board, std::span<const double> displacement)
      : problem_(problem), board_(board), displacement_(displacement), patches_(problem) {
    near_.reserve(board.most_within(kNeighbourhood * board.h()));
  }
  /// From now on that of another displacement.
  void take(std::span<const double> displacement) { displacement_ = displacement; }

  /// Over the destructible elements.
  [[nodiscard]] std::optional<InPlane> at(const Vec2& p) const override;

 private:
  const Problem& problem_;
  const Board& board_;
  std::span<const double> displacement_;
  mutable std::vector<Index> near_;  // of the place being looked at
  mutable PatchChanges patches_;
};

}  // namespace sunder::fracture
