#version 460
// SPDX-License-Identifier: Apache-2.0
// p = z + (r^T z of now / r^T z of before) p. The first workgroup keeps the state; at convergence it
// sets the size of all further dispatches to 0.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer RzPartial { double data[]; } rz_partial;
INOUT(1, State, CgState, state)
OUT(2, Arguments, uint, arguments)
IN_DVEC4(3, Z, z)
INOUT(4, P, dvec4, direction)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint n = gl_GlobalInvocationID.x;
  double sum = 0;
  for (uint g = gl_LocalInvocationID.x; g < p.groups; g += kGroup) sum += rz_partial.data[g];
  const double now = group_sum(sum);
  const double before = state.data[0].rz[p.parity];
  direction.data[n] = DVEC4(z, n) + (now / before) * direction.data[n];
  if (n == 0u) {
    const bool broken = !(now >= 0) || isinf(now);
    const bool run = !broken && now > state.data[0].target;
    state.data[0].rz[1u - p.parity] = now;
    state.data[0].iterations += 1u;
    state.data[0].broken = broken ? 1u : 0u;
    state.data[0].running = run ? 1u : 0u;
    arguments.data[0] = run ? p.groups : 0u;
  }
}
