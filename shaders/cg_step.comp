#version 460
// SPDX-License-Identifier: Apache-2.0
// x += a p, r -= a q, z = D^-1 r; partial sums of r^T z.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer State { CgState data[]; } state;
IN_UVEC4(1, Preconditioner, m)  // the upper triangle of each block's inverse, row by row
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
  STORE_THREE(x.data[n], DVEC4(x_before, n).xyz + a * DVEC4(direction, n).xyz);
  const dvec3 rn = DVEC4(r_before, n).xyz - a * DVEC4(q, n).xyz;
  const uvec4 first = UVEC4(m, 3u * n), second = UVEC4(m, 3u * n + 1u), third = UVEC4(m, 3u * n + 2u);
  const double xy = packDouble2x32(first.zw), xz = packDouble2x32(second.xy),
               yz = packDouble2x32(third.xy);
  const dvec3 zn = dvec3(dot(dvec3(packDouble2x32(first.xy), xy, xz), rn),
                         dot(dvec3(xy, packDouble2x32(second.zw), yz), rn),
                         dot(dvec3(xz, yz, packDouble2x32(third.zw)), rn));
  STORE_THREE(r.data[n], rn);
  STORE_THREE(z_.data[n], zn);
  const double rz = part_sum(dot(rn, zn));
  if (leads_part()) rz_partial.data[part()] = rz;
}
