#version 460
// SPDX-License-Identifier: Apache-2.0
// r = f - K u over the unknowns, gathered node by node in the order of the elements. At a gripped
// dof f - K u is minus the grip's reaction, and r = 0.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Force, force)
IN_WORDS(1, Start, start)      // of each node's corners
IN_WORDS(2, Corner, corners)   // 4 * element + corner
IN_UVEC4(3, Dofs, dofs)        // x, y, z; w: gripped axes as bits
layout(std430, set = 0, binding = 4) readonly buffer Load { double data[]; } load;
OUT(5, Balance, double, balance)    // f - K u
OUT(6, Residual, double, residual)  // r
OUT(7, NodePartial, dvec2, node_partial)
layout(push_constant) uniform Push { ElementPush p; };

shared double residual_sum[kGroup];
shared double reaction_sum[kGroup];

void main() {
  const uint n = gl_GlobalInvocationID.x;
  dvec3 k_u = dvec3(0);
  const uint last = start.data[n + 1u];
  for (uint c = start.data[n]; c < last; ++c) k_u += DVEC4(force, corners.data[c]).xyz;
  const uvec4 dof = UVEC4(dofs, n);
  double free_squared = 0, held_squared = 0;
  [[unroll]] for (int axis = 0; axis < 3; ++axis) {
    if (dof[axis] != kHeld) {
      const double gap = load.data[dof[axis]] - k_u[axis];
      const bool gripped = (dof.w >> axis & 1u) != 0u;
      balance.data[dof[axis]] = gap;
      residual.data[dof[axis]] = gripped ? 0.0LF : gap;
      if (gripped) held_squared += gap * gap;
      else free_squared += gap * gap;
    }
  }
  const uint lane = gl_LocalInvocationID.x;
  residual_sum[lane] = free_squared;
  reaction_sum[lane] = held_squared;
  for (uint half_ = kGroup / 2u; half_ > 0u; half_ /= 2u) {
    barrier();
    if (lane < half_) {
      residual_sum[lane] += residual_sum[lane + half_];
      reaction_sum[lane] += reaction_sum[lane + half_];
    }
  }
  if (lane == 0u) node_partial.data[gl_WorkGroupID.x] = dvec2(residual_sum[0], reaction_sum[0]);
}
