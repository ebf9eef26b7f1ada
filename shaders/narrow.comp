#version 460
// SPDX-License-Identifier: Apache-2.0
// A vector rounded to fp32, for the dense product with an inverse stored so: read once for every
// column there, it would cost more than the matrix.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Vector, vector)
OUT(1, Narrow, vec4, narrow)

void main() {
  const uint pack = invocation();
  narrow.data[pack] = vec4(DVEC4(vector, pack));
}
