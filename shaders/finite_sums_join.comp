#version 460
// SPDX-License-Identifier: Apache-2.0
// One workgroup: what the shares of finite_sums come to together.
#extension GL_GOOGLE_include_directive : require
#include "finite_sums_fold.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Shares { FiniteSums data[]; } shares;
OUT(1, Sums, FiniteSums, sums)
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  FiniteSums of = no_sums();
  for (uint i = gl_LocalInvocationID.x; i < p.shares; i += gl_WorkGroupSize.x) {
    const FiniteSums share = shares.data[i];
    of = FiniteSums(of.energy + share.energy, of.viscous + share.viscous, of.springs + share.springs,
                    of.residual_squared + share.residual_squared,
                    of.held_squared + share.held_squared,
                    of.inertia_squared + share.inertia_squared,
                    max(of.stress_squared, share.stress_squared),
                    max(of.change_squared, share.change_squared), of.slope + share.slope,
                    of.s_y + share.s_y, of.s_squared + share.s_squared,
                    of.y_squared + share.y_squared);
  }
  of = folded(of);
  if (gl_LocalInvocationID.x == 0u) sums.data[0] = of;
}
