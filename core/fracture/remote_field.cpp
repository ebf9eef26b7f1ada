// SPDX-License-Identifier: Apache-2.0
#include "fracture/remote_field.hpp"

namespace sunder::fracture {

std::optional<InPlane> RemoteField::along(const Vec2& from, const Vec2& to) const {
  constexpr int kStations = 9;
  InPlane sum = InPlane::Zero();
  int count = 0;
  for (int k = 0; k < kStations; ++k) {
    const auto stress = at(from + (k + 0.5) / kStations * (to - from));
    if (!stress) continue;
    sum += *stress;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace sunder::fracture
