#version 460
// SPDX-License-Identifier: Apache-2.0
// partial[chunk] = sum of X(:, j) r_j over the chunk's columns: the dense product u = X r.
// Sums in fp64. Reads the whole matrix once; columns and vector are padded with zeros.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_REAL4(0, Matrix, matrix)
IN_DVEC4(1, Vector, vector)
OUT(2, Partial, dvec4, partial)
layout(push_constant) uniform Push { ApplyPush p; };

void main() {
  const uint pack = gl_GlobalInvocationID.x;
  const uint first = gl_WorkGroupID.y * kChunk;
  dvec4 sum = dvec4(0);
  for (uint j = first; j < first + kChunk; j += 4u) {
    const dvec4 c = DVEC4(vector, p.vector_first + j / 4u);
    const uint at = j * p.packs + pack;
    sum += dvec4(LOAD_REAL4(matrix, at)) * c.x;
    sum += dvec4(LOAD_REAL4(matrix, at + p.packs)) * c.y;
    sum += dvec4(LOAD_REAL4(matrix, at + 2u * p.packs)) * c.z;
    sum += dvec4(LOAD_REAL4(matrix, at + 3u * p.packs)) * c.w;
  }
  partial.data[(p.partial + gl_WorkGroupID.y) * p.packs + pack] = sum;
}
