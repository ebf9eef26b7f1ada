#version 460
// SPDX-License-Identifier: Apache-2.0
// q = K p from 3 x 3 blocks in slices of 64 rows (SELL) and differences: K's rows sum to zero
// (block_matrix.hpp). Partial sums of p^T q. Reads 48 bytes a block in fp32, 96 in fp64.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

IN_REAL4(0, Blocks, blocks)  // three rows a block; the fourth value of the first: the column
IN_WORDS(1, Slices, slices)  // first block of each slice, / 64
IN_UVEC4(2, Dofs, dofs)
IN_REAL4(3, P, direction)
OUT_REAL4(4, Q, q)
OUT(5, Partial, double, partial)

void main() {
  const uint n = gl_GlobalInvocationID.x, slice = gl_WorkGroupID.x;
  const REAL3 own = LOAD_REAL4(direction, n).xyz;
  REAL3 sum = REAL3(0);
  const uint last = slices.data[slice + 1u];
  for (uint k = slices.data[slice]; k < last; ++k) {
    const uint at = 3u * (k * kGroup + gl_LocalInvocationID.x);
    const REAL4 row = LOAD_REAL4(blocks, at);
    const REAL3 d = LOAD_REAL4(direction, uint(row.w)).xyz - own;
    sum += times(row, LOAD_REAL4(blocks, at + 1u), LOAD_REAL4(blocks, at + 2u), d);
  }
  sum = mix(sum, REAL3(0), held_axes(UVEC4(dofs, n)));
  q.data[n] = stored(REAL4(sum, 0));
  const double pq = part_sum(dot(dvec3(sum), dvec3(own)));
  if (leads_part()) partial.data[part()] = pq;
}
