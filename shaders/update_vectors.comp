#version 460
// SPDX-License-Identifier: Apache-2.0
// Z = X(:, T) V, six update vectors (one element's share of the rank) a workgroup row.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_REAL4(0, Matrix, matrix)
IN_WORDS(1, Dofs, dofs)
IN_DVEC4(2, Factors, v)  // two for each dof and block: six values and two zeros
INOUT(3, Vectors, REAL4, z)
layout(push_constant) uniform Push { VectorsPush p; };
#include "lower.glsl"

void main() {
  const uint pack = invocation(), block = gl_WorkGroupID.y;
  dvec4 sum[kRankBlock];
  [[unroll]] for (uint k = 0u; k < kRankBlock; ++k) sum[k] = dvec4(0);
  for (uint t = p.first; t < p.last; ++t) {
    const dvec4 x = dvec4(of_column(dofs.data[t], pack));
    const dvec4 a = DVEC4(v, 2u * (t * p.blocks + block));
    const dvec4 b = DVEC4(v, 2u * (t * p.blocks + block) + 1u);
    sum[0] += x * a.x;
    sum[1] += x * a.y;
    sum[2] += x * a.z;
    sum[3] += x * a.w;
    sum[4] += x * b.x;
    sum[5] += x * b.y;
  }
  [[unroll]] for (uint k = 0u; k < kRankBlock; ++k) {
    const uint at = (block * kRankBlock + k) * p.packs + pack;
    z.data[at] = p.add != 0u ? z.data[at] + REAL4(sum[k]) : REAL4(sum[k]);
  }
}
