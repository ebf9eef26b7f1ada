// SPDX-License-Identifier: Apache-2.0
// A place in the body and a radius around it, as a caller gives them.
#pragma once

#include <string>

#include "c/failure.hpp"
#include "sunder/types.hpp"

namespace sunder::c {

inline Vec3 to_place(const double* values, const char* what) {
  require(values, what);
  require_finite(values, 3, what);
  return Vec3(values);
}

inline double to_radius(double radius) {
  require_finite(radius, "radius");
  if (!(radius > 0)) {
    throw Failure(SUNDER_ERROR_VALUE,
                  "radius = " + std::to_string(radius) + "; it must be above 0 mm");
  }
  return radius;
}

}  // namespace sunder::c
