#version 460
// SPDX-License-Identifier: Apache-2.0
// partial[chunk] = sum of X(:, column_j) c_j over the chunk's entries: u = X f for few loaded dofs.
// Sums in fp64 whatever X is stored in. Reads n values per entry.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_REAL4(0, Matrix, matrix)
IN_UVEC4(1, Entries, entries)
OUT(2, Partial, dvec4, partial)
layout(push_constant) uniform Push { ApplyPush p; };

void main() {
  const uint pack = gl_GlobalInvocationID.x;
  const uint first = p.first + gl_WorkGroupID.y * kChunk;
  const uint last = min(first + kChunk, p.last);
  dvec4 sum = dvec4(0);
  for (uint j = first; j < last; ++j) {
    const uvec4 entry = UVEC4(entries, j);
    sum += dvec4(LOAD_REAL4(matrix, entry.x * p.packs + pack)) * packDouble2x32(entry.zw);
  }
  partial.data[(p.partial + gl_WorkGroupID.y) * p.packs + pack] = sum;
}
