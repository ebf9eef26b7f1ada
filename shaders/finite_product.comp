#version 460
// SPDX-License-Identifier: Apache-2.0
// Partial sums of the base's dense inverse times a vector: four rows an invocation, kFiniteChunk columns.
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

IN_REAL4(0, Inverse, inverse)  // by columns, padded to kColumnPad rows
IN_DOUBLES(1, Vector, q)
OUT(2, Partial, dvec4, partial)
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  const uint packs = (p.unknowns + kColumnPad - 1u) / kColumnPad * (kColumnPad / 4u);
  const uint pack = gl_GlobalInvocationID.x, chunk = gl_WorkGroupID.y;
  if (pack >= packs) return;
  const uint last = min(p.unknowns, (chunk + 1u) * kFiniteChunk);
  dvec4 sum = dvec4(0);
  for (uint column = chunk * kFiniteChunk; column < last; ++column) {
    sum += dvec4(LOAD_REAL4(inverse, column * packs + pack)) * q.data[column];
  }
  partial.data[chunk * packs + pack] = sum;
}
