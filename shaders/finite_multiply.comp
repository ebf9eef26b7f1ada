#version 460
// SPDX-License-Identifier: Apache-2.0
// q = T p at the nodes, by ascending element, with the springs of inertia; partial sums of p^T q.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Corners { double data[]; } corners;
IN_WORDS(1, First, first)    // of each node
IN_WORDS(2, Around, around)  // 4 * element + corner
IN_UVEC4(3, Dofs, dofs)
layout(std430, set = 0, binding = 4) readonly buffer Target { double data[]; } target;  // as finite_gather
IN_DVEC4(5, P, direction)
OUT(6, Q, dvec4, q)
OUT(7, Partial, double, partial)
layout(push_constant) uniform Push { FiniteCgPush p; };

void main() {
  const uint n = invocation();
  dvec3 sum = dvec3(0);
  const dvec3 own = DVEC4(direction, n).xyz;
  if (n < p.nodes) {
    const uint last = first.data[n + 1u];
    for (uint k = first.data[n]; k < last; ++k) {
      const uint at = 3u * around.data[k];
      sum += dvec3(corners.data[at], corners.data[at + 1u], corners.data[at + 2u]);
    }
    const uvec4 dof = UVEC4(dofs, n);
    [[unroll]] for (uint axis = 0u; axis < 3u; ++axis) {
      if (dof[axis] != kHeld) sum[axis] += target.data[p.unknowns + dof[axis]] * own[axis];
    }
    sum = mix(sum, dvec3(0), held_axes(dof));
    STORE_THREE(q.data[n], sum);
  }
  const double pq = part_sum(dot(sum, own));
  if (leads_part()) partial.data[part()] = pq;
}
