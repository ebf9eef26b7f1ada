#version 460
// SPDX-License-Identifier: Apache-2.0
// C = keep A + Z^T W in fp64: of C, by columns, a workgroup sums 64 rows of some columns, in the order of
// Z's and W's rows. `lower`: the tiles over the diagonal of a square C are left as they are. How it was
// divided up leaves no trace in the bits.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Before, before)  // A
IN_DVEC4(1, Left, left)      // Z, row by row: one of C's columns long
IN_DVEC4(2, Right, right)    // W, row by row
OUT(3, After, dvec4, after)  // C
layout(push_constant) uniform Push { ProductPush p; };

const uint kAlong = kTile / 4u;  // invocations side by side along a tile's rows
#ifdef SUNDER_LVP
const uint kAcross = 1u;
#else
const uint kAcross = kGroup / kAlong;
const uint kColumnPacks = kAcross * kUpdateColumns / 4u;
shared dvec4 of_columns[kColumnPacks * kDepth];  // W at the workgroup's columns
#endif

void main() {
  const uint lane = gl_LocalInvocationID.x, across = kAcross > 1u ? lane / kAlong : 0u;
  const uint tile = workgroup(), group_column = gl_WorkGroupID.y * kAcross * kUpdateColumns;
  const uint column = p.column + group_column + across * kUpdateColumns;  // of this panel
  if (p.lower != 0u && tile < (p.first_column + p.column + group_column) / kTile) return;
  const uint first = tile * kAlong + lane % kAlong;
  dvec4 sum[kUpdateColumns];
  [[unroll]] for (uint c = 0u; c < kUpdateColumns; ++c) sum[c] = dvec4(0);
  for (uint base = 0u; base < p.depth; base += kDepth) {
#ifdef SUNDER_LVP
    const uint at_columns = base * p.right_packs + (p.right_first + column) / 4u;
#else
    barrier();
    of_columns[lane] =
        DVEC4(right, (base + lane / kColumnPacks) * p.right_packs +
                         (p.right_first + p.column + group_column) / 4u + lane % kColumnPacks);
    barrier();
#endif
    [[unroll]] for (uint k = 0u; k < kDepth; ++k) {
#ifdef SUNDER_LVP
      const dvec4 low = DVEC4(right, at_columns + k * p.right_packs),
                  high = DVEC4(right, at_columns + k * p.right_packs + 1u);
#else
      const uint at = k * kColumnPacks + across * (kUpdateColumns / 4u);
      const dvec4 low = of_columns[at], high = of_columns[at + 1u];
#endif
      const dvec4 row = DVEC4(left, (base + k) * p.packs + first);
      [[unroll]] for (uint c = 0u; c < 4u; ++c) {
        sum[c] += row * low[c];
        sum[c + 4u] += row * high[c];
      }
    }
  }
  [[unroll]] for (uint c = 0u; c < kUpdateColumns; ++c) {
    const uint at = (column + c) * p.packs + first;
    dvec4 value = sum[c];
    if (p.keep != 0.0) value += double(p.keep) * DVEC4(before, at);
    after.data[at] = p.packs != 0u ? value : dvec4(0);  // always; as in low_rank.comp
  }
}
