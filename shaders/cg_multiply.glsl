// SPDX-License-Identifier: Apache-2.0
// q = K p from 3 x 3 blocks in slices of 64 rows (SELL) and differences: K's rows sum to zero
// (block_matrix.hpp). Partial sums of p^T q. Reads 96 bytes a block. SUNDER_POOLED: patches of pooled
// volume add their forces.
#include "cg.glsl"

IN_DVEC4(0, Blocks, blocks)  // three rows a block; the fourth value of the first: the column
IN_WORDS(1, Slices, slices)  // first block of each slice, / 64
IN_UVEC4(2, Dofs, dofs)
IN_DVEC4(3, P, direction)
OUT(4, Q, dvec4, q)
OUT(5, Partial, double, partial)
#ifdef SUNDER_POOLED
#define SUNDER_PATCH_BINDING 6
#include "patch_forces.glsl"
#endif

void main() {
  const uint n = invocation(), slice = workgroup();
  const dvec3 own = DVEC4(direction, n).xyz;
  dvec3 sum = dvec3(0);
  const uint last = slices.data[slice + 1u];
  for (uint k = slices.data[slice]; k < last; ++k) {
    const uint at = 3u * (k * kGroup + gl_LocalInvocationID.x);
    const dvec4 row = DVEC4(blocks, at);
    const dvec3 d = DVEC4(direction, uint(row.w)).xyz - own;
    sum += times(row, DVEC4(blocks, at + 1u), DVEC4(blocks, at + 2u), d);
  }
#ifdef SUNDER_POOLED
  sum += force_of_patches(slice);
#endif
  sum = mix(sum, dvec3(0), held_axes(UVEC4(dofs, n)));
  q.data[n] = dvec4(sum, 0);
  const double pq = part_sum(dot(sum, own));
  if (leads_part()) partial.data[part()] = pq;
}
