#version 460
// SPDX-License-Identifier: Apache-2.0
// What a host draws: displacement, stress and liveness in fp32, for its own shaders.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "two_float.glsl"

IN_WIDE4(0, Nodal, u)
IN_REAL4(1, Stress, stress)  // two an element: (xx, yy, zz, xy), (yz, zx, measure, ratio)
layout(std430, set = 0, binding = 2) readonly buffer Facts { ElementFacts data[]; } facts;
OUT(3, Displacement, vec4, displacement)
OUT(4, Colour, vec2, colour)  // measure [MPa], ratio to yield
OUT(5, Live, uint, live)
layout(push_constant) uniform Push { DisplayPush p; };

void main() {
  const uint i = invocation();
  if (i < p.nodes) {
#ifdef SUNDER_SINGLE
    const Two3 x = two3(VEC4(u, 2u * i), VEC4(u, 2u * i + 1u));
    displacement.data[i] = vec4(x.high + x.low, 0.0);
#else
    displacement.data[i] = vec4(vec3(DVEC4(u, i).xyz), 0.0);
#endif
  }
  if (i < p.elements) {
    const uint place = p.stress != 0u ? 2u * i + 1u : 0u;
    const vec2 read = vec2(LOAD_REAL4(stress, place).zw);
    colour.data[i] = p.stress != 0u ? read : vec2(0.0);
    live.data[i] = (facts.data[i].state & kDestroyed) == 0u ? 1u : 0u;
  }
}
