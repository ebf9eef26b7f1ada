#version 460
// SPDX-License-Identifier: Apache-2.0
// partial[chunk] = sum of X(:, j) r_j over the chunk's columns: the dense product u = X r, which
// estimates errors and refines. 64 products are summed in storage precision, which the vector has as
// well, chunks in fp64. Reads the whole matrix once, or its lower tiles twice; columns and vector are
// padded with zeros.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_REAL4(0, Matrix, matrix)
IN_REAL4(1, Vector, vector)
INOUT(2, Partial, WIDE4, partial)
layout(push_constant) uniform Push { ApplyPush p; };
layout(constant_id = 2) const uint kLower = 0u;  // 1: tiles over the diagonal do not count

#ifndef SUNDER_LVP
shared REAL4 coefficients[kChunk / 4u];
#endif

REAL4 coefficient(uint j) {
#ifdef SUNDER_LVP
  return LOAD_REAL4(vector, p.vector_first + (p.first + gl_WorkGroupID.y) * (kChunk / 4u) + j);
#else
  return coefficients[j];
#endif
}

REAL4 whole(uint pack) {
  REAL4 sum = REAL4(0);
  uint at = gl_WorkGroupID.y * kChunk * p.packs + pack;
  [[unroll]] for (uint j = 0u; j < kChunk / 4u; ++j) {
    const REAL4 c = coefficient(j);
    sum += LOAD_REAL4(matrix, at) * c.x;
    sum += LOAD_REAL4(matrix, at + p.packs) * c.y;
    sum += LOAD_REAL4(matrix, at + 2u * p.packs) * c.z;
    sum += LOAD_REAL4(matrix, at + 3u * p.packs) * c.w;
    at += 4u * p.packs;
  }
  return sum;
}

// A tile over the diagonal is the transpose of one under it: the same 64 reads a pack, by rows of
// four columns in place of by columns of four rows.
REAL4 lower(uint pack) {
  const uint tile = p.first + gl_WorkGroupID.y;
  const bool direct = 4u * pack / kTile >= tile;
  const uint within = (direct ? tile * kTile : 4u * pack) - p.first_column;
  const bool here = within < p.columns;
  uint at = here ? within * p.packs + (direct ? pack : tile * (kTile / 4u)) : 0u;
  const uint step = here ? (direct ? 4u * p.packs : 1u) : 0u;
  REAL4 down = REAL4(0), across = REAL4(0);
  [[unroll]] for (uint j = 0u; j < kChunk / 4u; ++j) {
    const REAL4 c = coefficient(j), x = LOAD_REAL4(matrix, at), y = LOAD_REAL4(matrix, at + p.packs),
                z = LOAD_REAL4(matrix, at + 2u * p.packs), w = LOAD_REAL4(matrix, at + 3u * p.packs);
    down += x * c.x + y * c.y + z * c.z + w * c.w;
    across += REAL4(dot(x, c), dot(y, c), dot(z, c), dot(w, c));
    at += step;
  }
  return here ? (direct ? down : across) : REAL4(0);
}

void main() {
  const uint pack = invocation();
#ifndef SUNDER_LVP
  const uint lane = gl_LocalInvocationID.x;
  if (lane < kChunk / 4u) {
    coefficients[lane] = LOAD_REAL4(
        vector, p.vector_first + (p.first + gl_WorkGroupID.y) * (kChunk / 4u) + lane);
  }
  barrier();
#endif
  REAL4 sum;
  if (kLower != 0u) {
    sum = lower(pack);
  } else {
    sum = whole(pack);
  }
  const uint to = (p.partial + gl_WorkGroupID.y) * p.packs + pack;
  // Keeps the arithmetic out of lavapipe's store loop (low_rank.comp).
#ifdef SUNDER_SINGLE  // high and low part
  partial.data[2u * to] = p.packs != 0u ? sum : vec4(0);
  partial.data[2u * to + 1u] = vec4(0);
#else
  dvec4 value = dvec4(sum);
  if (kLower != 0u && p.add != 0u) value += partial.data[to];
  partial.data[to] = p.packs != 0u ? value : dvec4(0);
#endif
}
