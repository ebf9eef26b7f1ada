#version 460
// SPDX-License-Identifier: Apache-2.0
// One workgroup: the worst of all partial results, and the sums of f - K u, in a fixed order.
#extension GL_GOOGLE_include_directive : require
#include "summary.glsl"

OUT(2, Summaries, Summary, summaries)
layout(std430, set = 0, binding = 3) buffer Over {
  uint count;
  uint elements[];
} over;

void main() {
  const Found all = join_parts(0u, p.element_parts, p.node_parts);
  if (gl_LocalInvocationID.x != 0u) return;
  summaries.data[p.slot] =
      Summary(all.any.ratio, all.candidate.ratio, all.stress_squared, all.sums.x, all.sums.y,
              all.sums.z, all.any.element, all.candidate.element, over.count,
              all.deformation.x, all.deformation.y, all.deformation.z, all.handed_out);
  if (p.slot == 0u) over.count = 0u;  // the next frame's list begins anew
}
