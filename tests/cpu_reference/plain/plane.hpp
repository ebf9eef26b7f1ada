// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sunder/scene.hpp"

namespace sunder::test {

/// The nodes of a small body on a plane across an axis.
inline Box plane(int axis, double at) {
  Box box{Vec3::Constant(-9), Vec3::Constant(9)};
  box.min[axis] = at - 1e-6;
  box.max[axis] = at + 1e-6;
  return box;
}

}  // namespace sunder::test
