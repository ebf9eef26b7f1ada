#version 460
// SPDX-License-Identifier: Apache-2.0
// x += a p / s in fp64, r -= a q, z = D^-1 r; partial sums of r^T z.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer State { CgState data[]; } state;
IN_REAL4(1, Preconditioner, m)
IN_REAL4(2, P, direction)
IN_REAL4(3, Q, q)
IN_DVEC4(4, XBefore, x_before)  // the same memory as x and r; each invocation its own values
IN_REAL4(5, RBefore, r_before)
OUT(6, X, dvec4, x)
OUT_REAL4(7, R, r)
OUT_REAL4(8, Z, z)
OUT(9, RzPartial, double, rz_partial)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint n = gl_GlobalInvocationID.x;
  const double a = state.data[0].length_;
  x.data[n] = DVEC4(x_before, n) + (a / p.scale) * dvec4(LOAD_REAL4(direction, n));
  const REAL3 rn = LOAD_REAL4(r_before, n).xyz - REAL(a) * LOAD_REAL4(q, n).xyz;
  const REAL3 zn = times(LOAD_REAL4(m, 3u * n), LOAD_REAL4(m, 3u * n + 1u),
                         LOAD_REAL4(m, 3u * n + 2u), rn);
  r.data[n] = stored(REAL4(rn, 0));
  z.data[n] = stored(REAL4(zn, 0));
  const double rz = part_sum(dot(dvec3(rn), dvec3(zn)));
  if (leads_part()) rz_partial.data[part()] = rz;
}
