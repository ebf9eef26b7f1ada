#version 460
// SPDX-License-Identifier: Apache-2.0
// w of groups = S y + Q w of aggregates (gpu/passes/rigid_levels.hpp), an invocation a group, and
// partial sums of y^T w. Reads 160 bytes a block.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"
#include "cg_six.glsl"

IN_UVEC4(0, Blocks, blocks)   // of S, then of Q
IN_WORDS(1, Slices, slices)   // first block of each slice, / 64, of S and then of Q
IN_UVEC4(2, Y, y)             // six values a group
IN_DVEC4(3, Coarse, coarse)   // of each aggregate: shift, turn
OUT(4, W, dvec4, w)           // of each group: shift, turn
OUT(5, Terms, double, terms)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint g = invocation(), slice = workgroup();
  Six sum = Six(dvec3(0), dvec3(0));
  const uint end = slices.data[slice + 1u];
  for (uint k = slices.data[slice]; k < end; ++k) {
    const uint at = kSixPacks * (k * kGroup + gl_LocalInvocationID.x);
    const uint group = SIX_COLUMN(blocks, at);
    add_product(sum, SIX_BLOCK(blocks, at), SIX_OF_GROUP(y, group));
  }
  const uint of_q = slice + p.rigid_rows + 1u, last = slices.data[of_q + 1u];
  for (uint k = slices.data[of_q]; k < last; ++k) {
    const uint at = kSixPacks * (k * kGroup + gl_LocalInvocationID.x);
    const uint aggregate = SIX_COLUMN(blocks, at);
    add_product(sum, SIX_BLOCK(blocks, at),
                Six(DVEC4(coarse, 2u * aggregate).xyz, DVEC4(coarse, 2u * aggregate + 1u).xyz));
  }
  const Six own = SIX_OF_GROUP(y, g);
  w.data[2u * g] = dvec4(sum.shift, 0);
  w.data[2u * g + 1u] = dvec4(sum.turn, 0);
  const double term = part_sum(dot(own.shift, sum.shift) + dot(own.turn, sum.turn));
  if (leads_part()) terms.data[part()] = term;
}
