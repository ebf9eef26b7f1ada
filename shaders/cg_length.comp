#version 460
// SPDX-License-Identifier: Apache-2.0
// One workgroup: a = r^T M r / p^T q.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

IN_DVEC4(0, PqPartial, pq_partial)
INOUT(1, State, CgState, state)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  double sum = 0;
  for (uint i = gl_LocalInvocationID.x; i < p.partials; i += gl_WorkGroupSize.x) {
    const dvec4 of = DVEC4(pq_partial, i);
    sum += (of.x + of.y) + (of.z + of.w);
  }
  const double pq = part_sum(sum);
  if (gl_LocalInvocationID.x == 0u) {
    // A direction that K does not take as positive ends the iteration; NaN included.
    const bool sound = pq > 0 && !isinf(pq);
    state.data[0].length_ = sound ? state.data[0].rz / pq : 0.0LF;
    state.data[0].broken = sound ? 0u : 1u;
  }
}
