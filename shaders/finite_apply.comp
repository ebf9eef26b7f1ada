#version 460
// SPDX-License-Identifier: Apache-2.0
// Of every element: its tangent times a direction, on its corners.
#extension GL_GOOGLE_include_directive : require
#include "finite_cg.glsl"

layout(std430, set = 0, binding = 2) readonly buffer Nodes { uvec4 data[]; } nodes;
IN_DVEC4(3, P, direction)
OUT(4, Corners, double, corners)

void main() {
  const uint e = invocation();
  if (e >= p.elements) return;
  const uvec4 n = nodes.data[e];
  const dvec3 first = DVEC4(direction, n.x).xyz;
  const dvec3 d1 = DVEC4(direction, n.y).xyz - first, d2 = DVEC4(direction, n.z).xyz - first,
              d3 = DVEC4(direction, n.w).xyz - first;
  const dvec3 g1 = slope(e, 1u), g2 = slope(e, 2u), g3 = slope(e, 3u);
  double way[9], made[9];
  [[unroll]] for (uint j = 0u; j < 3u; ++j) {
    const dvec3 column = d1 * g1[j] + d2 * g2[j] + d3 * g3[j];
    [[unroll]] for (uint i = 0u; i < 3u; ++i) {
      way[3u * j + i] = column[i];
      made[3u * j + i] = 0;
    }
  }
  const Tangent k = load(e);
  [[unroll]] for (uint b = 0u; b < 9u; ++b) {
    [[unroll]] for (uint a = 0u; a <= b; ++a) {
      const double value = k.upper[b * (b + 1u) / 2u + a];
      made[a] += value * way[b];
      if (a != b) made[b] += value * way[a];
    }
  }
  const dmat3 stress = dmat3(made[0], made[1], made[2], made[3], made[4], made[5], made[6], made[7],
                             made[8]);
  const dvec3 f1 = stress * g1, f2 = stress * g2, f3 = stress * g3, f0 = -(f1 + f2 + f3);
  [[unroll]] for (uint i = 0u; i < 3u; ++i) {
    corners.data[12u * e + i] = f0[i];
    corners.data[12u * e + 3u + i] = f1[i];
    corners.data[12u * e + 6u + i] = f2[i];
    corners.data[12u * e + 9u + i] = f3[i];
  }
}
