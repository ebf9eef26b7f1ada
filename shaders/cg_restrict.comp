#version 460
// SPDX-License-Identifier: Apache-2.0
// y = Z^T r: a workgroup for each group of nodes, six sums over its nodes in their order.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

IN_WORDS(0, Lists, lists)  // first of each group, then nodes
layout(std430, set = 0, binding = 1) readonly buffer Modes { dvec4 data[]; } modes;
layout(std430, set = 0, binding = 2) readonly buffer R { dvec4 data[]; } r;
OUT(3, Y, double, y)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint group = gl_WorkGroupID.x;
  dvec3 force = dvec3(0), moment = dvec3(0);
  for (uint i = lists.data[group] + gl_LocalInvocationID.x; i < lists.data[group + 1u];
       i += kGroup) {
    const uint n = lists.data[i];
    const dvec3 rn = r.data[n].xyz;
    force += rn;
    moment += cross(modes.data[n].xyz, rn);
  }
  const double sums[6] =
      double[6](group_sum(force.x), group_sum(force.y), group_sum(force.z), group_sum(moment.x),
                group_sum(moment.y), group_sum(moment.z));
  if (gl_LocalInvocationID.x == 0u) {
    for (uint k = 0u; k < 6u; ++k) y.data[6u * group + k] = sums[k];
  }
}
