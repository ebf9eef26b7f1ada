#version 460
// SPDX-License-Identifier: Apache-2.0
// X += Z Z^T (or -=), rank 6 k, in one pass over the 64 x 64 tiles of X on and under the diagonal: those
// over it are left out of date, for half of the traffic (lower.glsl). A workgroup holds some columns of
// one tile while it walks through the rank. Memory traffic: half of X read and written once, Z from the
// cache. Rank 6, one element's event, is a kernel of its own: straight on from Z's rows, no sum to keep.
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_gpu_shader_int64 : enable
#include "common.glsl"

layout(constant_id = 2) const uint kOneBlock = 0u;  // 1: the rank is 6

// lavapipe stores lane by lane: eight floats at once as four 64-bit words, and a select that is always
// true keeps the arithmetic out of that loop (Mesa 22.3.6: 8 against 84 GFLOP/s).
#if defined(SUNDER_LVP) && !defined(SUNDER_FP64)
#define PACKS 2
#define STORED u64vec4
#else
#define PACKS 1
#define STORED REAL4
#endif

// Invocations side by side along a tile's rows; `lvp` has no more of them in a workgroup.
const uint kAlong = kTile / 4u / PACKS;
#ifdef SUNDER_LVP
const uint kAcross = 1u;
const uint kTurns = kOneBlock != 0u ? kUpdateTurns : 1u;
#else
const uint kAcross = kGroup / kAlong;
const uint kTurns = 1u;
#endif
const uint kGroupColumns = kAcross * kTurns * kUpdateColumns;

IN_REAL4(0, Matrix, matrix)
IN_REAL4(1, Vectors, z)
OUT(2, Updated, STORED, updated)  // the same memory as `matrix`; each invocation its own values
layout(push_constant) uniform Push { LowRankPush p; };

#ifndef SUNDER_LVP
const uint kColumnPacks = kAcross * kUpdateColumns / 4u;
shared REAL4 z_column[kColumnPacks * kRankBlock];  // Z at the workgroup's columns
#endif

#if PACKS == 2
u64vec4 stored(vec4 a, vec4 b) {
  const bool always = p.packs != 0u;
  const vec4 a_ = always ? a : vec4(0), b_ = always ? b : vec4(0);
  return u64vec4(packUint2x32(floatBitsToUint(a_.xy)), packUint2x32(floatBitsToUint(a_.zw)),
                 packUint2x32(floatBitsToUint(b_.xy)), packUint2x32(floatBitsToUint(b_.zw)));
}
#endif

// Columns of X from `column` on, rows from pack `first` on, plus what the update adds there.
void leave(uint column, uint first, uint c, REAL4 sum[PACKS]) {
  const uint at = (column + c) * p.packs + first;
#if PACKS == 2
  updated.data[at / 2u] =
      stored(LOAD_REAL4(matrix, at) + sum[0], LOAD_REAL4(matrix, at + 1u) + sum[1]);
#else
  const REAL4 value = LOAD_REAL4(matrix, at) + sum[0];
  updated.data[at] = p.packs != 0u ? value : REAL4(0);
#endif
}

void update_by_one_block(uint column, uint first) {
  REAL4 row[PACKS * kRankBlock];
  [[unroll]] for (uint k = 0u; k < kRankBlock; ++k) {
    [[unroll]] for (uint q = 0u; q < PACKS; ++q) {
      row[PACKS * k + q] = REAL(p.sign) * LOAD_REAL4(z, k * p.packs + first + q);
    }
  }
  [[unroll]] for (uint four = 0u; four < kTurns * kUpdateColumns; four += 4u) {
    const uint at_columns = (p.first_column + column + four) / 4u;
    REAL4 of_columns[kRankBlock];
    [[unroll]] for (uint k = 0u; k < kRankBlock; ++k) {
      of_columns[k] = LOAD_REAL4(z, at_columns + k * p.packs);
    }
    [[unroll]] for (uint c = 0u; c < 4u; ++c) {
      REAL4 sum[PACKS];
      [[unroll]] for (uint q = 0u; q < PACKS; ++q) {
        sum[q] = REAL4(0);
        [[unroll]] for (uint k = 0u; k < kRankBlock; ++k) {
          sum[q] += row[PACKS * k + q] * of_columns[k][c];
        }
      }
      leave(column, first, four + c, sum);
    }
  }
}

void update_by_blocks(uint column, uint first, uint across) {
  REAL4 sum[PACKS * kUpdateColumns];
  [[unroll]] for (uint c = 0u; c < PACKS * kUpdateColumns; ++c) sum[c] = REAL4(0);
  for (uint block = 0u; block < p.blocks; ++block) {
    const uint base = block * kRankBlock;
    const uint at_columns = base * p.packs + (p.first_column + column) / 4u;
#ifndef SUNDER_LVP
    const uint lane = gl_LocalInvocationID.x;
    barrier();
    if (lane < kColumnPacks * kRankBlock) {
      z_column[lane] = LOAD_REAL4(z, at_columns - across * (kUpdateColumns / 4u) +
                                         lane / kColumnPacks * p.packs + lane % kColumnPacks);
    }
    barrier();
#endif
    [[unroll]] for (uint k = 0u; k < kRankBlock; ++k) {
#ifdef SUNDER_LVP  // a barrier would spill all sums to memory
      const REAL4 low = REAL(p.sign) * LOAD_REAL4(z, at_columns + k * p.packs),
                  high = REAL(p.sign) * LOAD_REAL4(z, at_columns + k * p.packs + 1u);
#else
      const uint at = k * kColumnPacks + across * (kUpdateColumns / 4u);
      const REAL4 low = REAL(p.sign) * z_column[at], high = REAL(p.sign) * z_column[at + 1u];
#endif
      [[unroll]] for (uint q = 0u; q < PACKS; ++q) {
        const REAL4 row = LOAD_REAL4(z, (base + k) * p.packs + first + q);
        [[unroll]] for (uint c = 0u; c < 4u; ++c) {
          sum[PACKS * c + q] += row * low[c];
          sum[PACKS * (c + 4u) + q] += row * high[c];
        }
      }
    }
  }
  [[unroll]] for (uint c = 0u; c < kUpdateColumns; ++c) {
    REAL4 of_column[PACKS];
    [[unroll]] for (uint q = 0u; q < PACKS; ++q) of_column[q] = sum[PACKS * c + q];
    leave(column, first, c, of_column);
  }
}

// Workgroups before column j of tiles, when each tile takes one and columns begin at the diagonal.
uint tiles_before(uint j) { return j * p.tiles - j * (j - 1u) / 2u; }

void main() {
  // Down the tiles of some columns, then on to the next columns: memory is passed through in order.
  const uint parts = kTile / kGroupColumns;
  const uint group = workgroup();
  const float h = float(2u * p.tiles + 1u);
  uint j = uint(max(0.0, (h - sqrt(h * h - 8.0 * float(group / parts))) * 0.5));
  j = parts * tiles_before(j) > group ? j - 1u : j;
  j = parts * tiles_before(j + 1u) <= group ? j + 1u : j;
  const uint rest = group - parts * tiles_before(j), rows = p.tiles - j;
  const uint lane = gl_LocalInvocationID.x, across = kAcross > 1u ? lane / kAlong : 0u;
  const uint tile = p.first_column / kTile + j + rest % rows;
  const uint first = tile * (kTile / 4u) + lane % kAlong * PACKS;
  const uint column = j * kTile + rest / rows * kGroupColumns + across * kUpdateColumns;
  if (kOneBlock != 0u) {
    update_by_one_block(column, first);
  } else {
    update_by_blocks(column, first, across);
  }
}
