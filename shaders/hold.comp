#version 460
// SPDX-License-Identifier: Apache-2.0
// Gripped dofs get exactly what is prescribed there: rounding in the grips' forces would otherwise
// stay, for refinement moves everything but them.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_WORDS(0, Held, held)  // positions among the nodes' values
layout(std430, set = 0, binding = 1) readonly buffer Prescribed { NODAL data[]; } prescribed;
INOUT(2, Nodal, NODAL, u)
layout(push_constant) uniform Push { HoldPush p; };

void main() {
  const uint g = invocation();
  if (g < p.count) u.data[held.data[g]] = p.to_zero != 0u ? NODAL(0) : prescribed.data[g];
}
