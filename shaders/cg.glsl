// SPDX-License-Identifier: Apache-2.0
// Shared by the kernels of conjugate gradients: vectors have four values a node, dofs that a support
// or a grip holds stay 0.
#include "common.glsl"
#include "reduce.glsl"
#include "part_sum.glsl"

const uint kNodeAxes = 7u;  // of a node's word: axes held; above them its group, kHeld: none

bvec3 held_axes(uvec4 dofs) {
  return bvec3(dofs.x == kHeld || (dofs.w & 1u) != 0u, dofs.y == kHeld || (dofs.w & 2u) != 0u,
               dofs.z == kHeld || (dofs.w & 4u) != 0u);
}
