#version 460
// SPDX-License-Identifier: Apache-2.0
// Of every patch of pooled volume: v . p of its vector v (patch_vectors.hpp). The values of v at its
// nodes add up to zero, so that v . p is summed from differences to the first node, as the rest of
// K p is. Reads 32 bytes a node of a patch.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Vectors, vectors)  // v at a node, and the node
IN_WORDS(1, Ranges, ranges)    // first of each slice and behind its last, / 64
IN_DVEC4(2, P, direction)
OUT(3, Sums, dvec2, sums)  // the second: 0

void main() {
  const uint slice = workgroup(), last = ranges.data[2u * slice + 1u];
  uint k = ranges.data[2u * slice];
  if (k >= last) return;  // room for parts that are not there
  const dvec3 first = DVEC4(direction, number_in(DVEC4(vectors, k * kGroup + gl_LocalInvocationID.x).w)).xyz;
  double sum = 0;
  for (++k; k < last; ++k) {
    const dvec4 v = DVEC4(vectors, k * kGroup + gl_LocalInvocationID.x);
    sum += dot(v.xyz, DVEC4(direction, number_in(v.w)).xyz - first);
  }
  sums.data[invocation()] = dvec2(sum, 0);
}
