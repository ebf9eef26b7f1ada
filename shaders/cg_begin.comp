#version 460
// SPDX-License-Identifier: Apache-2.0
// r = f - K u; p = u where it is free, or 0 without a guess; partial sums of r^T p. The first step goes
// along u: it makes the best multiple of the last solution the first guess.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Residual { double data[]; } residual;
IN_UVEC4(1, Dofs, dofs)
IN_DVEC4(2, Displacement, u)
OUT(3, R, dvec4, r)
OUT(4, P, dvec4, direction)
OUT(5, Partial, double, partial)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint n = invocation();
  const uvec4 dof = UVEC4(dofs, n);
  dvec3 gap = dvec3(0);
  [[unroll]] for (int axis = 0; axis < 3; ++axis) {
    if (dof[axis] != kHeld) gap[axis] = residual.data[dof[axis]];
  }
  const bvec3 held = held_axes(dof);
  const dvec3 rn = mix(gap, dvec3(0), held);
  const dvec3 pn = p.guess == 1u ? mix(DVEC4(u, n).xyz, dvec3(0), held) : dvec3(0);
  r.data[n] = dvec4(rn, 0);
  direction.data[n] = dvec4(pn, 0);
  const double sum = part_sum(dot(rn, pn));
  if (leads_part()) partial.data[part()] = sum;
}
