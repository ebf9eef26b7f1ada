#version 460
// SPDX-License-Identifier: Apache-2.0
// x += a p, r -= a q, z = D^-1 r; partial sums of r^T z.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer State { CgState data[]; } state;
IN_DVEC4(1, Preconditioner, m)
IN_DVEC4(2, P, direction)
IN_DVEC4(3, Q, q)
IN_DVEC4(4, XBefore, x_before)  // the same memory as x and r; each invocation its own values
IN_DVEC4(5, RBefore, r_before)
OUT(6, X, dvec4, x)
OUT(7, R, dvec4, r)
OUT(8, Z, dvec4, z_)
OUT(9, RzPartial, double, rz_partial)

void main() {
  const uint n = invocation();
  const double a = state.data[0].length_;
  x.data[n] = dvec4(DVEC4(x_before, n).xyz + a * DVEC4(direction, n).xyz, 0);
  const dvec3 rn = DVEC4(r_before, n).xyz - a * DVEC4(q, n).xyz;
  const dvec3 zn = times(DVEC4(m, 3u * n), DVEC4(m, 3u * n + 1u),
                         DVEC4(m, 3u * n + 2u), rn);
  r.data[n] = dvec4(rn, 0);
  z_.data[n] = dvec4(zn, 0);
  const double rz = part_sum(dot(rn, zn));
  if (leads_part()) rz_partial.data[part()] = rz;
}
