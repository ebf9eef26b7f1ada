#version 460
// SPDX-License-Identifier: Apache-2.0
// Partial sums of the base's dense inverse times a vector: four rows an invocation, kChunk columns summed in
// storage precision. Rows and columns are padded to kChunk, the vector with zeros.
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

IN_REAL4(0, Inverse, inverse)  // by columns
IN_DVEC4(1, Vector, q)
OUT(2, Partial, dvec4, partial)
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  const uint packs = (p.unknowns + kChunk - 1u) / kChunk * (kChunk / 4u);
  const uint pack = invocation(), chunk = gl_WorkGroupID.y;
  const bool here = pack < packs;
  uint at = here ? chunk * kChunk * packs + pack : 0u;
  REAL4 sum = REAL4(0);
  [[unroll]] for (uint j = 0u; j < kChunk / 4u; ++j) {
    const REAL4 c = REAL4(DVEC4(q, chunk * (kChunk / 4u) + j));
    sum += LOAD_REAL4(inverse, at) * c.x;
    sum += LOAD_REAL4(inverse, at + packs) * c.y;
    sum += LOAD_REAL4(inverse, at + 2u * packs) * c.z;
    sum += LOAD_REAL4(inverse, at + 3u * packs) * c.w;
    at += 4u * packs;
  }
  // Keeps the arithmetic out of lavapipe's store loop (low_rank.comp).
  const dvec4 value = packs != 0u ? dvec4(sum) : dvec4(0);
  if (here) partial.data[chunk * packs + pack] = value;
}
