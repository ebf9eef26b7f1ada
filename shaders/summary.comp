#version 460
// SPDX-License-Identifier: Apache-2.0
// One workgroup: the worst of all workgroups, and the sums of f - K u, in a fixed order.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(std430, set = 0, binding = 0) readonly buffer StressPartials { StressPartial data[]; } partials;
layout(std430, set = 0, binding = 1) readonly buffer NodePartial { dvec2 data[]; } node_partial;
OUT(2, Summaries, Summary, summaries)
layout(push_constant) uniform Push { SummaryPush p; };

shared Summary found[kGroup];

void keep_worse(inout Summary a, double any_ratio, uint any_element, double candidate_ratio,
                uint candidate_element, double stress_squared) {
  if (any_ratio > a.any_ratio || (any_ratio == a.any_ratio && any_element < a.any_element)) {
    a.any_ratio = any_ratio;
    a.any_element = any_element;
  }
  if (candidate_ratio > a.candidate_ratio ||
      (candidate_ratio == a.candidate_ratio && candidate_element < a.candidate_element)) {
    a.candidate_ratio = candidate_ratio;
    a.candidate_element = candidate_element;
  }
  a.stress_squared = max(a.stress_squared, stress_squared);
}

void main() {
  const uint lane = gl_LocalInvocationID.x;
  Summary mine = Summary(0.0LF, 0.0LF, 0.0LF, 0.0LF, 0.0LF, kHeld, kHeld);
  for (uint g = lane; g < p.element_groups; g += kGroup) {
    const StressPartial b = partials.data[g];
    keep_worse(mine, b.any_ratio, b.any_element, b.candidate_ratio, b.candidate_element,
               b.stress_squared);
  }
  for (uint g = lane; g < p.node_groups; g += kGroup) {
    const dvec2 b = node_partial.data[g];
    mine.residual_squared += b.x;
    mine.reaction_squared += b.y;
  }
  found[lane] = mine;
  for (uint half_ = kGroup / 2u; half_ > 0u; half_ /= 2u) {
    barrier();
    if (lane < half_) {
      const Summary b = found[lane + half_];
      Summary a = found[lane];
      keep_worse(a, b.any_ratio, b.any_element, b.candidate_ratio, b.candidate_element,
                 b.stress_squared);
      a.residual_squared += b.residual_squared;
      a.reaction_squared += b.reaction_squared;
      found[lane] = a;
    }
  }
  if (lane == 0u) summaries.data[p.slot] = found[0];
}
