#version 460
// SPDX-License-Identifier: Apache-2.0
// u += du.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

#ifdef SUNDER_SINGLE
#include "two_float.glsl"
IN_VEC4(0, Correction, correction)
INOUT(1, Nodal, vec4, u)
#else
IN_DVEC4(0, Correction, correction)
INOUT(1, Nodal, dvec4, u)
#endif
layout(push_constant) uniform Push { uint packs; };

void main() {
  const uint i = invocation();
#ifdef SUNDER_SINGLE
  if (i < packs) {
    const Two3 sum = plus(two3(u.data[2u * i], u.data[2u * i + 1u]),
                          two3(VEC4(correction, 2u * i), VEC4(correction, 2u * i + 1u)));
    precise const vec3 high = sum.high + sum.low;
    precise const vec3 low = sum.low - (high - sum.high);
    u.data[2u * i] = vec4(high.x, low.x, high.y, low.y);
    u.data[2u * i + 1u] = vec4(high.z, low.z, 0.0, 0.0);
  }
#else
  if (i < packs) u.data[i] += DVEC4(correction, i);
#endif
}
