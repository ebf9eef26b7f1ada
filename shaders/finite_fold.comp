#version 460
// SPDX-License-Identifier: Apache-2.0
// The partial sums of a product, added up in order.
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

IN_DOUBLES(0, Partial, partial)
OUT(1, Made, double, x)
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  const uint d = invocation();
  if (d >= p.unknowns) return;
  const uint rows = (p.unknowns + kChunk - 1u) / kChunk * kChunk;
  double sum = 0;
  for (uint chunk = 0u; chunk < rows / kChunk; ++chunk) sum += partial.data[chunk * rows + d];
  x.data[d] = sum;
}
