#version 460
// SPDX-License-Identifier: Apache-2.0
// u = (u +) sum of partial[chunk], chunks in order; from unknowns to nodes.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Partial, partial)
IN_UVEC4(1, Position, position)  // of each unknown among the nodes' values
INOUT(2, Nodal, double, u)
layout(push_constant) uniform Push { SumPush p; };

void main() {
  const uint pack = gl_GlobalInvocationID.x;
  dvec4 sum = dvec4(0);
  for (uint c = 0u; c < p.chunks; ++c) sum += DVEC4(partial, c * p.packs + pack);
  const uvec4 at = UVEC4(position, pack);
  if (p.add != 0u) sum += dvec4(u.data[at.x], u.data[at.y], u.data[at.z], u.data[at.w]);
  u.data[at.x] = sum.x;
  u.data[at.y] = sum.y;
  u.data[at.z] = sum.z;
  u.data[at.w] = sum.w;
}
