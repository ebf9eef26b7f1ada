#version 460
// SPDX-License-Identifier: Apache-2.0
// p = M r + (r^T M r of now / r^T M r of before) p with M r = z + Z w (rigid_space.hpp). The first workgroup keeps the state; at convergence it
// sets the size of all further dispatches to 0.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer RzPartial { double data[]; } rz_partial;
INOUT(1, State, CgState, state)
OUT(2, Arguments, uint, arguments)
IN_DVEC4(3, Z, z)
INOUT(4, P, dvec4, direction)
layout(std430, set = 0, binding = 5) readonly buffer W { double data[]; } w;
IN_DVEC4(6, Modes, modes)  // place in the group; its number, -1: none
IN_UVEC4(7, Dofs, dofs)
layout(push_constant) uniform Push { CgPush p; };

dvec4 rigid_part(uint n) {
  const dvec4 mode = DVEC4(modes, n);
  const uint first = 6u * uint(max(mode.w, 0.0LF));
  const dvec3 shift = dvec3(w.data[first], w.data[first + 1u], w.data[first + 2u]);
  const dvec3 turn = dvec3(w.data[first + 3u], w.data[first + 4u], w.data[first + 5u]);
  const dvec3 moved = shift + cross(turn, mode.xyz);
  return free_part(mode.w < 0 ? dvec3(0) : moved, UVEC4(dofs, n));
}

void main() {
  const uint n = gl_GlobalInvocationID.x;
  const dvec4 m_r = DVEC4(z, n) + rigid_part(n);
  if (p.parity == kFirst) {
    direction.data[n] = m_r;
    return;
  }
  double sum = 0;
  for (uint g = gl_LocalInvocationID.x; g < p.groups; g += kGroup) sum += rz_partial.data[g];
  for (uint i = gl_LocalInvocationID.x; i < 6u * p.rigid_groups; i += kGroup) {
    sum += w.data[kRigidTerms + i];
  }
  const double now = group_sum(sum);
  const double before = state.data[0].rz[p.parity];
  direction.data[n] = m_r + (now / before) * direction.data[n];
  if (n == 0u) {
    const bool broken = !(now >= 0) || isinf(now);
    const bool run = !broken && now > state.data[0].target;
    state.data[0].rz[1u - p.parity] = now;
    state.data[0].iterations += 1u;
    state.data[0].broken = broken ? 1u : 0u;
    state.data[0].running = run ? 1u : 0u;
    arguments.data[0] = run ? p.groups : 0u;
    arguments.data[3] = run ? p.rigid_groups : 0u;
    arguments.data[6] = run ? p.solve_groups : 0u;
  }
}
