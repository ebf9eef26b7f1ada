#version 460
// SPDX-License-Identifier: Apache-2.0
// x = 0, r = f - K u, z = D^-1 r; partial sums of r^T z.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Residual { double data[]; } residual;
IN_UVEC4(1, Dofs, dofs)
IN_DVEC4(2, Preconditioner, m)  // three rows a node
OUT(3, X, dvec4, x)
OUT(4, R, dvec4, r)
OUT(5, Z, dvec4, z_)
OUT(6, Partial, double, partial)

void main() {
  const uint n = gl_GlobalInvocationID.x;
  const uvec4 dof = UVEC4(dofs, n);
  dvec3 gap = dvec3(0);
  [[unroll]] for (int axis = 0; axis < 3; ++axis) {
    if (dof[axis] != kHeld) gap[axis] = residual.data[dof[axis]];
  }
  const dvec4 rn = free_part(gap, dof);
  const dvec3 z = dvec3(dot(DVEC4(m, 3u * n).xyz, rn.xyz), dot(DVEC4(m, 3u * n + 1u).xyz, rn.xyz),
                        dot(DVEC4(m, 3u * n + 2u).xyz, rn.xyz));
  x.data[n] = dvec4(0);
  r.data[n] = rn;
  z_.data[n] = dvec4(z, 0);
  const double sum = group_sum(dot(rn.xyz, z));
  if (gl_LocalInvocationID.x == 0u) partial.data[gl_WorkGroupID.x] = sum;
}
