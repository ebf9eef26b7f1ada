#version 460
// SPDX-License-Identifier: Apache-2.0
// y = Z^T r: a workgroup for each group of nodes, six sums over its nodes in a fixed order.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

IN_WORDS(0, First, first)    // of each group in the list
IN_UVEC4(1, Members, members)  // place in the group, fp32; node
IN_DVEC4(2, R, r)
OUT(3, Y, double, y)

void main() {
  const uint group = workgroup();
  dvec3 force = dvec3(0), moment = dvec3(0);
  const uint last = first.data[group + 1u];
  for (uint i = first.data[group] + gl_LocalInvocationID.x; i < last; i += gl_WorkGroupSize.x) {
    const uvec4 member = UVEC4(members, i);
    const dvec3 rn = DVEC4(r, member.w).xyz;
    force += rn;
    moment += cross(dvec3(uintBitsToFloat(member.xyz)), rn);
  }
  const double sums[6] =
      double[6](part_sum(force.x), part_sum(force.y), part_sum(force.z), part_sum(moment.x),
                part_sum(moment.y), part_sum(moment.z));
  if (gl_LocalInvocationID.x == 0u) {
    [[unroll]] for (uint k = 0u; k < 6u; ++k) y.data[6u * group + k] = sums[k];
  }
}
