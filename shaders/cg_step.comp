#version 460
// SPDX-License-Identifier: Apache-2.0
// x += a p, r -= a q with a = r^T M r / p^T q; z = D^-1 r; partial sums of r^T z. Every workgroup sums
// p^T q by itself, in the same order: cheaper than a dispatch of its own.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer PqPartial { double data[]; } pq_partial;
layout(std430, set = 0, binding = 1) readonly buffer State { CgState data[]; } state;
IN_DVEC4(2, Preconditioner, m)
IN_DVEC4(3, P, direction)
IN_DVEC4(4, Q, q)
INOUT(5, X, dvec4, x)
INOUT(6, R, dvec4, r)
OUT(7, Z, dvec4, z)
OUT(8, RzPartial, double, rz_partial)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint n = gl_GlobalInvocationID.x;
  double sum = 0;
  for (uint g = gl_LocalInvocationID.x; g < p.groups; g += kGroup) sum += pq_partial.data[g];
  const double pq = group_sum(sum);
  const double a = pq > 0 ? state.data[0].rz[p.parity] / pq : 0.0LF;
  x.data[n] += a * DVEC4(direction, n);
  const dvec4 rn = r.data[n] - a * DVEC4(q, n);
  const dvec3 zn = dvec3(dot(DVEC4(m, 3u * n).xyz, rn.xyz), dot(DVEC4(m, 3u * n + 1u).xyz, rn.xyz),
                         dot(DVEC4(m, 3u * n + 2u).xyz, rn.xyz));
  r.data[n] = rn;
  z.data[n] = dvec4(zn, 0);
  // A direction that K does not take as positive ends the iteration: NaN tells the next kernel.
  const double rz = group_sum(pq > 0 ? dot(rn.xyz, zn) : packDouble2x32(uvec2(0u, 0x7ff80000u)));
  if (gl_LocalInvocationID.x == 0u) rz_partial.data[gl_WorkGroupID.x] = rz;
}
