#version 460
// SPDX-License-Identifier: Apache-2.0
// One workgroup: the worst of all partial results, and the sums of f - K u, in a fixed order.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "reduce.glsl"

layout(std430, set = 0, binding = 0) readonly buffer StressPartials { StressPartial data[]; } partials;
layout(std430, set = 0, binding = 1) readonly buffer NodePartials { NodePartial data[]; } node_partials;
OUT(2, Summaries, Summary, summaries)
layout(std430, set = 0, binding = 3) buffer Over {
  uint count;
  uint elements[];
} over;
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

void main() {
  const uint lane = gl_LocalInvocationID.x;
  Found mine = Found(Worst(REAL(0), kHeld), Worst(REAL(0), kHeld), REAL(0), REAL3(0),
                     uvec3(0u), 0.0);
  for (uint g = lane; g < p.element_parts; g += kGroup) {
    const StressPartial b = partials.data[g];
    join(mine, Found(Worst(b.any_ratio, b.any_element), Worst(b.candidate_ratio, b.candidate_element),
                     b.stress_squared, REAL3(0),
                     uvec3(b.strain, b.half_tangent, b.inverted), b.handed_out));
  }
  for (uint g = lane; g < p.node_parts; g += kGroup) {
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
  if (lane == 0u) {
    Found all = found[0];
    for (uint s = 1u; s < gl_NumSubgroups; ++s) join(all, found[s]);
    summaries.data[p.slot] =
        Summary(all.any.ratio, all.candidate.ratio, all.stress_squared, all.sums.x, all.sums.y,
                all.sums.z, all.any.element, all.candidate.element, over.count,
                all.deformation.x, all.deformation.y, all.deformation.z, all.handed_out);
    if (p.slot == 0u) over.count = 0u;  // the next frame's list begins anew
  }
}
