#version 460
// SPDX-License-Identifier: Apache-2.0
// x += the inverse's columns of the touched unknowns times c.
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Inverse { REAL data[]; } inverse;
IN_WORDS(1, Touched, touched)
IN_DOUBLES(2, Coefficients, c)
layout(std430, set = 0, binding = 3) buffer Made { double data[]; } x;
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  const uint d = invocation();
  if (d >= p.unknowns) return;
  const uint rows = (p.unknowns + kChunk - 1u) / kChunk * kChunk;
  double sum = x.data[d];
  for (uint t = 0u; t < p.rank; ++t) {
    sum += double(inverse.data[touched.data[t] * rows + d]) * c.data[t];
  }
  x.data[d] = sum;
}
