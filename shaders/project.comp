#version 460
// SPDX-License-Identifier: Apache-2.0
// a_t = X(:, t)^T r, one workgroup a column of the exact columns.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Matrix, matrix)
IN_DVEC4(1, Vector, vector)
OUT(2, Result, double, result)
layout(push_constant) uniform Push { ProjectPush p; };

shared double sums[kGroup];

void main() {
  const uint lane = gl_LocalInvocationID.x;
  dvec4 sum = dvec4(0);
  for (uint pack = lane; pack < p.packs; pack += kGroup) {
    sum += DVEC4(matrix, gl_WorkGroupID.x * p.packs + pack) * DVEC4(vector, pack);
  }
  sums[lane] = (sum.x + sum.y) + (sum.z + sum.w);
  for (uint half_ = kGroup / 2u; half_ > 0u; half_ /= 2u) {
    barrier();
    if (lane < half_) sums[lane] += sums[lane + half_];
  }
  if (lane == 0u) result.data[gl_WorkGroupID.x] = sums[0];
}
