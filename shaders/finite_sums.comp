#version 460
// SPDX-License-Identifier: Apache-2.0
// What an iteration tells the host: by one workgroup, or by several of a share each, which
// finite_sums_join adds up.
#extension GL_GOOGLE_include_directive : require
#include "finite_sums_shares.glsl"

void main() {
  const FiniteSums of = sums_of(workgroup(), p.shares);
  if (gl_LocalInvocationID.x == 0u) sums.data[workgroup()] = of;
}
