#version 460
// SPDX-License-Identifier: Apache-2.0
// What has changed of a surface goes to where it is kept: triangles and their facts in a host's buffers,
// faces that show, corners and nodes that have come in our own.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_WORDS(0, Changes, changes)
OUT(1, Corners, uvec4, corners)
OUT(2, Shows, uint, shows)
OUT(3, Parents, uint, parents)
OUT(4, Triangles, uint, triangles)
OUT(5, Facts, uint, facts)
OUT(6, Elements, uint, elements)  // of triangles
layout(push_constant) uniform Push { SurfaceChangesPush p; };

void main() {
  const uint i = invocation();
  if (i < p.triangles) {
    const uint from = kTriangleWords * i;
    const uint place = changes.data[from];
    if (p.values != 0u) elements.data[place] = changes.data[from + 4u];
    for (uint k = 0u; k < 3u; ++k) {
      if (p.triangles_stride != 0u) {
        triangles.data[p.triangles_at + place * p.triangles_stride + k] = changes.data[from + 1u + k];
      }
      if (p.facts_stride != 0u) {
        facts.data[p.facts_at + place * p.facts_stride + k] = changes.data[from + 4u + k];
      }
    }
  }
  const uint elements_from = kTriangleWords * p.triangles;
  if (i < p.elements) {
    const uint from = elements_from + kElementWords * i;
    const uint e = changes.data[from];
    shows.data[e] = changes.data[from + 1u];
    corners.data[e] = uvec4(changes.data[from + 2u], changes.data[from + 3u], changes.data[from + 4u],
                            changes.data[from + 5u]);
  }
  if (i < p.nodes) {
    const uint from = elements_from + kElementWords * p.elements + kNodeWords * i;
    parents.data[changes.data[from]] = changes.data[from + 1u];
  }
}
