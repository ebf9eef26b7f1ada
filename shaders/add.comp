#version 460
// SPDX-License-Identifier: Apache-2.0
// u += du.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Correction, correction)
INOUT(1, Nodal, dvec4, u)
layout(push_constant) uniform Push { uint packs; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < packs) u.data[i] += DVEC4(correction, i);
}
