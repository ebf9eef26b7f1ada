#version 460
// SPDX-License-Identifier: Apache-2.0
// a_t = X(:, t)^T r, and behind all of them r at each column's unknown: a column for every part
// (reduce.glsl), a subgroup or a workgroup.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "reduce.glsl"

IN_DVEC4(0, Matrix, matrix)
IN_DVEC4(1, Vector, vector)
OUT(2, Result, double, result)
IN_WORDS(3, Dofs, dofs)  // of each column
layout(std430, set = 0, binding = 4) readonly buffer Values { double data[]; } values;  // r again
layout(push_constant) uniform Push { ProjectPush p; };

#ifndef SUNDER_LVP
shared double sums[kGroup];
#endif

void main() {
#ifdef SUNDER_LVP
  const uint lane = gl_SubgroupInvocationID, lanes = kSubgroup;
#else
  const uint lane = gl_LocalInvocationID.x, lanes = kGroup;
#endif
  const uint column = part();
  dvec4 sum = dvec4(0);
  for (uint pack = lane; pack < p.packs; pack += lanes) {
    sum += DVEC4(matrix, column * p.packs + pack) * DVEC4(vector, pack);
  }
  double all = subgroupAdd((sum.x + sum.y) + (sum.z + sum.w));
#ifndef SUNDER_LVP
  if (subgroupElect()) sums[gl_SubgroupID] = all;
  barrier();
  all = sums[0];
  for (uint s = 1u; s < gl_NumSubgroups; ++s) all += sums[s];
#endif
  if (leads_part()) {  // columns are padded to whole workgroups
    result.data[column] = all;
    result.data[p.capacity + column] = values.data[dofs.data[column]];
  }
}
