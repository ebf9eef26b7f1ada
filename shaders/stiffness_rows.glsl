// SPDX-License-Identifier: Apache-2.0
// A row of K v from 3 x 3 blocks in slices of 64 rows (SELL) and differences: K's rows sum to zero, so
// (K v)_i = sum_j K_ij (v_j - v_i) and a rigid offset costs no digits (block_matrix.hpp). Reads 80 bytes a
// block. SUNDER_ROWS_BINDING: the first of two; SUNDER_ROWS_OF(j): v of node j.
IN_UVEC4(SUNDER_ROWS_BINDING, Blocks, blocks)  // row by row, two words a value; the column; 0
IN_WORDS(SUNDER_ROWS_BINDING + 1, Slices, slices)  // first block of each slice, / 64

dvec3 stiffness_row(uint slice, dvec3 own) {
  dvec3 sum = dvec3(0);
  const uint last = slices.data[slice + 1u];
  for (uint k = slices.data[slice]; k < last; ++k) {
    const uint at = kBlockPacks * (k * kGroup + gl_LocalInvocationID.x);
    const uvec4 a = UVEC4(blocks, at), b = UVEC4(blocks, at + 1u), c = UVEC4(blocks, at + 2u),
                d = UVEC4(blocks, at + 3u), e = UVEC4(blocks, at + 4u);
    const dvec3 to = SUNDER_ROWS_OF(e.z) - own;
    sum += dvec3(dot(dvec3(packDouble2x32(a.xy), packDouble2x32(a.zw), packDouble2x32(b.xy)), to),
                 dot(dvec3(packDouble2x32(b.zw), packDouble2x32(c.xy), packDouble2x32(c.zw)), to),
                 dot(dvec3(packDouble2x32(d.xy), packDouble2x32(d.zw), packDouble2x32(e.xy)), to));
  }
  return sum;
}
