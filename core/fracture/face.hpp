// SPDX-License-Identifier: Apache-2.0
// Faces between elements, as cracks and blades open them.
#pragma once

#include "sunder/types.hpp"

namespace sunder::fracture {

/// The face of an element that lies opposite to one of its corners.
struct Face {
  Index element = 0;
  int opposite = 0;
  friend bool operator==(const Face&, const Face&) = default;
};

/// A face that a blade opens, and where in the undeformed body it passes there [mm].
struct PassedFace {
  Face face;
  Vec3 place = Vec3::Zero();
};

}  // namespace sunder::fracture
