#version 460
// SPDX-License-Identifier: Apache-2.0
// A vector by the nodes' rotations Q, or back: Q^T.
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Places { uvec4 data[]; } places;
IN_DOUBLES(1, Rotations, rotations)  // nine a node, by columns
layout(std430, set = 0, binding = 2) buffer Values { double data[]; } values;
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  const uint i = invocation();
  if (i >= p.turned) return;
  const uvec4 at = places.data[i];
  dmat3 q;
  [[unroll]] for (uint j = 0u; j < 3u; ++j) {
    [[unroll]] for (uint k = 0u; k < 3u; ++k) q[j][k] = rotations.data[9u * i + 3u * j + k];
  }
  const dvec3 v = dvec3(values.data[at.x], values.data[at.y], values.data[at.z]);
  const dvec3 w = p.back != 0u ? v * q : q * v;
  values.data[at.x] = w.x;
  values.data[at.y] = w.y;
  values.data[at.z] = w.z;
}
