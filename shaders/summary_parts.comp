#version 460
// SPDX-License-Identifier: Apache-2.0
// Where there are more partial results than one workgroup joins in good time: each workgroup joins some,
// and leaves one of either kind for the summary.
#extension GL_GOOGLE_include_directive : require
#include "summary.glsl"

OUT(2, JoinedPartials, StressPartial, joined)
OUT(3, JoinedNodePartials, NodePartial, joined_nodes)

void main() {
  const uint group = workgroup(), first = group * kPartsAtOnce, last = first + kPartsAtOnce;
  const Found all = join_parts(first, min(last, p.element_parts), min(last, p.node_parts));
  if (gl_LocalInvocationID.x != 0u) return;
  if (first < p.element_parts) {
    joined.data[group] =
        StressPartial(all.any.ratio, all.candidate.ratio, all.stress_squared, all.any.element,
                      all.candidate.element, all.deformation.x, all.deformation.y,
                      all.deformation.z, all.handed_out);
  }
  if (first < p.node_parts) {
    joined_nodes.data[group] = NodePartial(all.sums.x, all.sums.y, all.sums.z, WIDE(0));
  }
}
