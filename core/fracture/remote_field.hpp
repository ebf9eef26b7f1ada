// SPDX-License-Identifier: Apache-2.0
// A stress field smoothed over the destructible elements around a place, from which Eq. 3 takes its
// remote stress (method.md 5).
#pragma once

#include <optional>

#include "fracture/in_plane_stress.hpp"
#include "sunder/types.hpp"

namespace sunder::fracture {

class RemoteField {
 public:
  static constexpr double kNeighbourhood = 1.5;  // in h

  virtual ~RemoteField() = default;

  /// Volume-weighted mean over the elements that count within 1.5 h of p; none when there is none.
  [[nodiscard]] virtual std::optional<InPlane> at(const Vec2& p) const = 0;

  /// Mean of at() over 9 stations between two points, empty neighbourhoods skipped; none when all
  /// are empty.
  [[nodiscard]] std::optional<InPlane> along(const Vec2& from, const Vec2& to) const;
};

}  // namespace sunder::fracture
