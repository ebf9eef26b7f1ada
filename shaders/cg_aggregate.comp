#version 460
// SPDX-License-Identifier: Apache-2.0
// y of aggregates = Q^T y of groups (gpu/passes/rigid_levels.hpp): a workgroup for each aggregate, six
// sums over its groups in a fixed order. Reads 160 bytes a block.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"
#include "cg_six.glsl"

IN_WORDS(0, First, first)  // block of each aggregate
IN_UVEC4(1, Blocks, blocks)
IN_UVEC4(2, Y, y)  // six values a group
OUT(3, Sums, double, sums)

void main() {
  const uint aggregate = workgroup();
  Six sum = Six(dvec3(0), dvec3(0));
  const uint last = first.data[aggregate + 1u];
  for (uint k = first.data[aggregate] + gl_LocalInvocationID.x; k < last;
       k += gl_WorkGroupSize.x) {
    const uint at = kSixPacks * k, group = SIX_COLUMN(blocks, at);
    add_product(sum, SIX_BLOCK(blocks, at), SIX_OF_GROUP(y, group));
  }
  const double all[6] = double[6](part_sum(sum.shift.x), part_sum(sum.shift.y), part_sum(sum.shift.z),
                                  part_sum(sum.turn.x), part_sum(sum.turn.y), part_sum(sum.turn.z));
  if (gl_LocalInvocationID.x == 0u) {
    [[unroll]] for (uint k = 0u; k < 6u; ++k) sums.data[6u * aggregate + k] = all[k];
  }
}
