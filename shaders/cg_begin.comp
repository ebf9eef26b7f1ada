#version 460
// SPDX-License-Identifier: Apache-2.0
// r = s (f - K u), z = D^-1 r; partial sums of r^T z. The scale s, a power of two, keeps fp32 away from
// the ends of its range.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Residual { double data[]; } residual;
IN_UVEC4(1, Dofs, dofs)
IN_REAL4(2, Preconditioner, m)  // three rows a node
OUT_REAL4(3, R, r)
OUT_REAL4(4, Z, z)
OUT(5, Partial, double, partial)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint n = gl_GlobalInvocationID.x;
  const uvec4 dof = UVEC4(dofs, n);
  dvec3 gap = dvec3(0);
  [[unroll]] for (int axis = 0; axis < 3; ++axis) {
    if (dof[axis] != kHeld) gap[axis] = residual.data[dof[axis]];
  }
  const REAL3 rn = mix(REAL3(p.scale * gap), REAL3(0), held_axes(dof));
  const REAL3 zn = times(LOAD_REAL4(m, 3u * n), LOAD_REAL4(m, 3u * n + 1u),
                         LOAD_REAL4(m, 3u * n + 2u), rn);
  r.data[n] = stored(REAL4(rn, 0));
  z.data[n] = stored(REAL4(zn, 0));
  const double sum = part_sum(dot(dvec3(rn), dvec3(zn)));
  if (leads_part()) partial.data[part()] = sum;
}
