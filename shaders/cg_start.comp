#version 460
// SPDX-License-Identifier: Apache-2.0
// One workgroup: r^T M r of the start, the target, and the size of the dispatches to come.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Partial { double data[]; } partial;
OUT(1, State, CgState, state)
OUT(2, Arguments, uint, arguments)
layout(std430, set = 0, binding = 3) readonly buffer W { double data[]; } w;
layout(push_constant) uniform Push { CgPush p; };

void main() {
  double sum = 0;
  for (uint g = gl_LocalInvocationID.x; g < p.groups; g += kGroup) sum += partial.data[g];
  for (uint i = gl_LocalInvocationID.x; i < 6u * p.rigid_groups; i += kGroup) {
    sum += w.data[kRigidTerms + i];
  }
  const double rz = group_sum(sum);
  if (gl_LocalInvocationID.x == 0u) {
    const bool run = rz > 0;
    state.data[0].rz[0] = rz;
    state.data[0].rz[1] = 0;
    state.data[0].target = rz * p.reduction;
    state.data[0].iterations = 0u;
    state.data[0].broken = rz >= 0 ? 0u : 1u;  // NaN included
    state.data[0].running = run ? 1u : 0u;
    state.data[0].unused = 0u;
    for (uint i = 0u; i < 9u; ++i) arguments.data[i] = 1u;
    arguments.data[0] = run ? p.groups : 0u;
    arguments.data[3] = run ? p.rigid_groups : 0u;
    arguments.data[6] = run ? p.solve_groups : 0u;
  }
}
