#version 460
// SPDX-License-Identifier: Apache-2.0
// to = from + part du at the unknowns.
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Entries { uvec2 data[]; } entries;
IN_DOUBLES(1, From, from)
IN_DOUBLES(2, Direction, du)
OUT(3, To, double, to)
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  const uint i = invocation();
  if (i >= p.entries) return;
  const uint d = entries.data[i].x;
  to.data[i] = d == kHeld ? from.data[i] : from.data[i] + p.part * du.data[d];
}
