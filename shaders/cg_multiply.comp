#version 460
// SPDX-License-Identifier: Apache-2.0
// q = K p from 3 x 3 blocks in slices of 64 rows (SELL); partial sums of p^T q.
// Reads 100 bytes a block.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

IN_DVEC4(0, Blocks, blocks)  // three rows a block
IN_WORDS(1, Columns, columns)
IN_WORDS(2, Slices, slices)  // first block of each slice, / 64
IN_UVEC4(3, Dofs, dofs)
IN_DVEC4(4, P, direction)
OUT(5, Q, dvec4, q)
OUT(6, Partial, double, partial)

void main() {
  const uint n = gl_GlobalInvocationID.x, slice = gl_WorkGroupID.x;
  const uint lane = gl_LocalInvocationID.x;
  dvec3 sum = dvec3(0);
  for (uint k = slices.data[slice]; k < slices.data[slice + 1u]; ++k) {
    const uint at = k * kGroup + lane;
    const dvec3 v = DVEC4(direction, columns.data[at]).xyz;
    sum += dvec3(dot(DVEC4(blocks, 3u * at).xyz, v), dot(DVEC4(blocks, 3u * at + 1u).xyz, v),
                 dot(DVEC4(blocks, 3u * at + 2u).xyz, v));
  }
  const dvec4 qn = free_part(sum, UVEC4(dofs, n));
  q.data[n] = qn;
  const double pq = group_sum(dot(qn.xyz, DVEC4(direction, n).xyz));
  if (lane == 0u) partial.data[slice] = pq;
}
