#version 460
// SPDX-License-Identifier: Apache-2.0
// u = (u +) sum of partial[chunk], chunks in order; from unknowns to nodes.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_WIDE4(0, Partial, partial)
IN_UVEC4(1, Position, position)  // of each unknown among the nodes' values
INOUT(2, Nodal, NODAL, u)
layout(push_constant) uniform Push { SumPush p; };

#ifdef SUNDER_SINGLE
void main() {
  const uint pack = invocation();
  const uvec4 at = UVEC4(position, pack);
  vec4 sum = vec4(0), low = vec4(0);
  if (p.add != 0u) {
    [[unroll]] for (uint i = 0u; i < 4u; ++i) {
      sum[i] = u.data[at[i]].x;
      low[i] = u.data[at[i]].y;
    }
  }
  for (uint c = 0u; c < p.chunks; ++c) {
    const vec4 part = VEC4(partial, 2u * (c * p.packs + pack));
    precise const vec4 both = sum + part;
    precise const vec4 of_part = both - sum;
    precise const vec4 rest = (sum - (both - of_part)) + (part - of_part);
    low += rest + VEC4(partial, 2u * (c * p.packs + pack) + 1u);
    sum = both;
  }
  precise const vec4 high = sum + low;
  precise const vec4 rest = low - (high - sum);
  [[unroll]] for (uint i = 0u; i < 4u; ++i) u.data[at[i]] = vec2(high[i], rest[i]);
}
#else
void main() {
  const uint pack = invocation();
  dvec4 sum = dvec4(0);
  for (uint c = 0u; c < p.chunks; ++c) sum += DVEC4(partial, c * p.packs + pack);
  const uvec4 at = UVEC4(position, pack);
  if (p.add != 0u) sum += dvec4(u.data[at.x], u.data[at.y], u.data[at.z], u.data[at.w]);
  u.data[at.x] = sum.x;
  u.data[at.y] = sum.y;
  u.data[at.z] = sum.z;
  u.data[at.w] = sum.w;
}
#endif
