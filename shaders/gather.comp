#version 460
// SPDX-License-Identifier: Apache-2.0
// picked(i) = values(place_i), of eight bytes each: what the host asks for, side by side.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Values { uvec2 data[]; } values;
IN_WORDS(1, Places, places)
OUT(2, Picked, uvec2, picked)
layout(push_constant) uniform Push { GatherPush p; };

void main() {
  const uint i = invocation();
  if (i < p.count) picked.data[i] = values.data[places.data[i]];
}
