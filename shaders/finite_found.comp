#version 460
// SPDX-License-Identifier: Apache-2.0
// The direction of a step: what conjugate gradients found; where their first direction is one of negative
// stiffness, that one.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer State { CgState data[]; } state;
IN_UVEC4(1, Dofs, dofs)
IN_DVEC4(2, X, x)
IN_DVEC4(3, P, direction)
layout(std430, set = 0, binding = 4) writeonly buffer Direction { double data[]; } du;
layout(push_constant) uniform Push { FiniteCgPush p; };

void main() {
  const uint n = invocation();
  if (n >= p.nodes) return;
  const bool downhill = state.data[0].broken != 0u && state.data[0].iterations <= 1u;
  const dvec3 way = downhill ? DVEC4(direction, n).xyz : DVEC4(x, n).xyz;
  const uvec4 dof = UVEC4(dofs, n);
  const bvec3 held = held_axes(dof);
  [[unroll]] for (uint axis = 0u; axis < 3u; ++axis) {
    if (dof[axis] != kHeld) du.data[dof[axis]] = held[axis] ? 0.0LF : -way[axis];
  }
}
