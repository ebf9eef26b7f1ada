// SPDX-License-Identifier: Apache-2.0
// Partial results of elements and nodes joined by one workgroup, in a fixed order.
#include "common.glsl"
#include "reduce.glsl"

layout(std430, set = 0, binding = 0) readonly buffer StressPartials { StressPartial data[]; } partials;
layout(std430, set = 0, binding = 1) readonly buffer NodePartials { NodePartial data[]; } node_partials;
layout(push_constant) uniform Push { SummaryPush p; };

struct Found {
  Worst any, candidate;
  REAL stress_squared;
  REAL3 sums;  // the last one: a largest
  uvec3 deformation;  // strain, half_tangent, inverted
  float handed_out;
};
shared Found found[kGroup];

void join(inout Found a, Found b) {
  keep_worse(a.any, b.any);
  keep_worse(a.candidate, b.candidate);
  a.stress_squared = max(a.stress_squared, b.stress_squared);
  a.sums = REAL3(a.sums.xy + b.sums.xy, max(a.sums.z, b.sums.z));
  a.deformation =
      uvec3(max(a.deformation.xy, b.deformation.xy), a.deformation.z + b.deformation.z);
  a.handed_out = max(a.handed_out, b.handed_out);
}

// Of the parts from `first` on, before `last_element` and `last_node`; known to invocation 0.
Found join_parts(uint first, uint last_element, uint last_node) {
  const uint lane = gl_LocalInvocationID.x;
  Found mine = Found(Worst(REAL(0), kHeld), Worst(REAL(0), kHeld), REAL(0), REAL3(0),
                     uvec3(0u), 0.0);
  for (uint g = first + lane; g < last_element; g += kGroup) {
    const StressPartial b = partials.data[g];
    join(mine, Found(Worst(b.any_ratio, b.any_element), Worst(b.candidate_ratio, b.candidate_element),
                     b.stress_squared, REAL3(0),
                     uvec3(b.strain, b.half_tangent, b.inverted), b.handed_out));
  }
  for (uint g = first + lane; g < last_node; g += kGroup) {
    const NodePartial b = node_partials.data[g];
    mine.sums = REAL3(mine.sums.x + b.residual_squared, mine.sums.y + b.reaction_squared,
                      max(mine.sums.z, b.largest_u));
  }
  mine.any = subgroup_worst(mine.any);
  mine.candidate = subgroup_worst(mine.candidate);
  mine.stress_squared = subgroupMax(mine.stress_squared);
  mine.handed_out = subgroupMax(mine.handed_out);
  mine.sums = REAL3(subgroupAdd(mine.sums.x), subgroupAdd(mine.sums.y), subgroupMax(mine.sums.z));
  mine.deformation =
      uvec3(subgroupMax(mine.deformation.x), subgroupMax(mine.deformation.y),
            subgroupAdd(mine.deformation.z));
  if (subgroupElect()) found[gl_SubgroupID] = mine;
  barrier();
  Found all = found[0];
  if (lane == 0u) {
    for (uint s = 1u; s < gl_NumSubgroups; ++s) join(all, found[s]);
  }
  return all;
}
