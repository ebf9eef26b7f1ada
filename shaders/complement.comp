#version 460
// SPDX-License-Identifier: Apache-2.0
// X = scale (I - B), rounded to storage precision: the last step of the inversion on the device.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Swept, swept)
OUT(1, Matrix, REAL4, matrix)
layout(push_constant) uniform Push { ComplementPush p; };

void main() {
  const uint pack = gl_GlobalInvocationID.x, column = gl_WorkGroupID.y;
  const uint diagonal = p.first_column + column;
  dvec4 value = -DVEC4(swept, (p.from + column) * p.packs + pack);
  [[unroll]] for (uint i = 0u; i < 4u; ++i) value[i] += 4u * pack + i == diagonal ? 1.0LF : 0.0LF;
  // Columns of padding stay zero.
  const dvec4 result = diagonal < p.unknowns ? p.scale * value : dvec4(0);
  matrix.data[(p.to + column) * p.packs + pack] = REAL4(result);
}
