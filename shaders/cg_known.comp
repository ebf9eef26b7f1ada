#version 460
// SPDX-License-Identifier: Apache-2.0
// p = a solution that is known, where it is free; partial sums of r^T p. First steps go along such.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Known { dvec4 data[]; } known;  // side by side
IN_UVEC4(1, Dofs, dofs)
IN_DVEC4(2, R, r)
OUT(3, P, dvec4, direction)
OUT(4, Partial, double, partial)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint n = invocation();
  const dvec3 solution = known.data[p.known * p.groups * kGroup + n].xyz;
  const dvec3 along = mix(solution, dvec3(0), held_axes(UVEC4(dofs, n)));
  direction.data[n] = dvec4(along, 0);
  const double sum = part_sum(dot(DVEC4(r, n).xyz, along));
  if (leads_part()) partial.data[part()] = sum;
}
