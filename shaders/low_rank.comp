#version 460
// SPDX-License-Identifier: Apache-2.0
// X += Z Z^T, rank 6 k, in one pass over X: a workgroup holds 256 rows of eight columns while it
// walks through the rank. Memory traffic: X read and written once, Z from the cache.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_REAL4(0, Matrix, matrix)
IN_REAL4(1, Vectors, z)
OUT(2, Updated, REAL4, updated)  // the same memory as `matrix`; each invocation its own values
layout(push_constant) uniform Push { LowRankPush p; };

shared REAL4 z_column[2u * kRankBlock];  // Z at the workgroup's eight columns

void main() {
  const uint pack = gl_GlobalInvocationID.x;
  const uint column = gl_WorkGroupID.y * kUpdateColumns;
  const uint lane = gl_LocalInvocationID.x;
  REAL4 sum[kUpdateColumns];
  [[unroll]] for (uint c = 0u; c < kUpdateColumns; ++c) sum[c] = REAL4(0);
  for (uint block = 0u; block < p.blocks; ++block) {
    const uint base = block * kRankBlock;
    barrier();
    if (lane < 2u * kRankBlock) {
      z_column[lane] = LOAD_REAL4(z, (base + lane / 2u) * p.packs +
                                         (p.first_column + column) / 4u + lane % 2u);
    }
    barrier();
    [[unroll]] for (uint k = 0u; k < kRankBlock; ++k) {
      const REAL4 row = LOAD_REAL4(z, (base + k) * p.packs + pack);
      [[unroll]] for (uint c = 0u; c < kUpdateColumns; ++c) {
        sum[c] += row * z_column[2u * k + c / 4u][c % 4u];
      }
    }
  }
  [[unroll]] for (uint c = 0u; c < kUpdateColumns; ++c) {
    const uint at = (column + c) * p.packs + pack;
    updated.data[at] = LOAD_REAL4(matrix, at) + sum[c];
  }
}
