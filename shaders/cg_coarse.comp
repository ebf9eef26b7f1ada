#version 460
// SPDX-License-Identifier: Apache-2.0
// w = (Z^T K Z)^-1 y, four rows a workgroup, and their share of y^T w.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

IN_DVEC4(0, Inverse, inverse_)
IN_DVEC4(1, Y, y)
OUT(2, W, double, w)  // of each group: shift, 0, turn, 0
OUT(3, Terms, double, terms)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint first = 4u * workgroup();
  dvec4 sum = dvec4(0);
  for (uint j = gl_LocalInvocationID.x; j < p.rigid_solves; j += gl_WorkGroupSize.x) {
    const dvec4 yj = DVEC4(y, j);
    [[unroll]] for (uint i = 0u; i < 4u; ++i) {
      sum[i] += dot(DVEC4(inverse_, (first + i) * p.rigid_solves + j), yj);
    }
  }
  const dvec4 wi =
      dvec4(part_sum(sum.x), part_sum(sum.y), part_sum(sum.z), part_sum(sum.w));
  if (gl_LocalInvocationID.x == 0u) {
    [[unroll]] for (uint i = 0u; i < 4u; ++i) {
      const uint row = first + i, k = row % 6u;
      w.data[8u * (row / 6u) + k + (k < 3u ? 0u : 1u)] = wi[i];
    }
    terms.data[workgroup()] = dot(wi, DVEC4(y, workgroup()));
  }
}
