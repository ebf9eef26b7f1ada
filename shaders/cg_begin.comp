#version 460
// SPDX-License-Identifier: Apache-2.0
// r = f - K u, z = D^-1 r; partial sums of r^T z.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Residual { double data[]; } residual;
IN_UVEC4(1, Dofs, dofs)
IN_DVEC4(2, Preconditioner, m)  // three rows a node
OUT(3, R, dvec4, r)
OUT(4, Z, dvec4, z_)
OUT(5, Partial, double, partial)

void main() {
  const uint n = gl_GlobalInvocationID.x;
  const uvec4 dof = UVEC4(dofs, n);
  dvec3 gap = dvec3(0);
  [[unroll]] for (int axis = 0; axis < 3; ++axis) {
    if (dof[axis] != kHeld) gap[axis] = residual.data[dof[axis]];
  }
  const dvec3 rn = mix(gap, dvec3(0), held_axes(dof));
  const dvec3 zn = times(DVEC4(m, 3u * n), DVEC4(m, 3u * n + 1u),
                         DVEC4(m, 3u * n + 2u), rn);
  r.data[n] = dvec4(rn, 0);
  z_.data[n] = dvec4(zn, 0);
  const double sum = part_sum(dot(rn, zn));
  if (leads_part()) partial.data[part()] = sum;
}
