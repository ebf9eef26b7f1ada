// SPDX-License-Identifier: Apache-2.0
// What pooled volume adds to K p at a node: v (v . p) of each of its patches (patch_vectors.hpp), of
// which patch_sums.comp has left the sums. Reads 48 bytes a patch of a node. SUNDER_PATCH_BINDING:
// the first of three.
IN_DVEC4(SUNDER_PATCH_BINDING, PatchVectors, patch_vectors)  // v at the node, and the patch
IN_WORDS(SUNDER_PATCH_BINDING + 1, PatchRanges, patch_ranges)  // first of each slice and behind its last, / 64
IN_UVEC4(SUNDER_PATCH_BINDING + 2, PatchSums, patch_sums)  // a double of each patch

dvec3 force_of_patches(uint slice) {
  dvec3 sum = dvec3(0);
  const uint last = patch_ranges.data[2u * slice + 1u];
  for (uint k = patch_ranges.data[2u * slice]; k < last; ++k) {
    const dvec4 v = DVEC4(patch_vectors, k * kGroup + gl_LocalInvocationID.x);
    sum += packDouble2x32(UVEC4(patch_sums, number_in(v.w)).xy) * v.xyz;
  }
  return sum;
}
