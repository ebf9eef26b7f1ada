#version 460
// SPDX-License-Identifier: Apache-2.0
// partial[chunk] = sum of X(:, j) r_j over the chunk's columns: the dense product u = X r, which
// estimates errors and refines. 64 products are summed in storage precision, which the vector has as
// well, chunks in fp64. Reads the whole matrix once; columns and vector are padded with zeros.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_REAL4(0, Matrix, matrix)
IN_REAL4(1, Vector, vector)
OUT(2, Partial, WIDE4, partial)
layout(push_constant) uniform Push { ApplyPush p; };

#ifndef SUNDER_LVP
shared REAL4 coefficients[kChunk / 4u];
#endif

void main() {
  const uint pack = gl_GlobalInvocationID.x, first = gl_WorkGroupID.y * kChunk;
  const uint lane = gl_LocalInvocationID.x;
#ifndef SUNDER_LVP
  if (lane < kChunk / 4u) {
    coefficients[lane] = LOAD_REAL4(vector, p.vector_first + first / 4u + lane);
  }
  barrier();
#endif
  REAL4 sum = REAL4(0);
  uint at = first * p.packs + pack;
  [[unroll]] for (uint j = 0u; j < kChunk / 4u; ++j) {
#ifdef SUNDER_LVP
    const REAL4 c = LOAD_REAL4(vector, p.vector_first + first / 4u + j);
#else
    const REAL4 c = coefficients[j];
#endif
    sum += LOAD_REAL4(matrix, at) * c.x;
    sum += LOAD_REAL4(matrix, at + p.packs) * c.y;
    sum += LOAD_REAL4(matrix, at + 2u * p.packs) * c.z;
    sum += LOAD_REAL4(matrix, at + 3u * p.packs) * c.w;
    at += 4u * p.packs;
  }
  const uint to = (p.partial + gl_WorkGroupID.y) * p.packs + pack;
  // Keeps the arithmetic out of lavapipe's store loop (low_rank.comp).
#ifdef SUNDER_SINGLE  // high and low part
  partial.data[2u * to] = p.packs != 0u ? sum : vec4(0);
  partial.data[2u * to + 1u] = vec4(0);
#else
  partial.data[to] = p.packs != 0u ? dvec4(sum) : dvec4(0);
#endif
}
