#version 460
// SPDX-License-Identifier: Apache-2.0
// One workgroup: the second loop of L-BFGS, from what the base makes of it to the direction.
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

IN_DOUBLES(0, Made, x)
IN_DOUBLES(1, Steps, s)
IN_DOUBLES(2, Changes, y)
IN_DOUBLES(3, Products, s_y)
IN_DOUBLES(4, Lengths, a)
IN_WORDS(5, Held, held)  // of each unknown
layout(std430, set = 0, binding = 6) buffer Direction { double data[]; } du;
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  const uint lane = gl_LocalInvocationID.x, lanes = gl_WorkGroupSize.x;
  const double by = 1.0LF / (1.0LF + p.viscous);  // the tangent of viscous forces
  for (uint d = lane; d < p.unknowns; d += lanes) {
    du.data[d] = held.data[d] != 0u ? 0.0LF : x.data[d] * by;
  }
  for (uint k = 0u; k < p.pairs; ++k) {
    const uint slot = (p.order >> (4u * k)) & 15u, at = slot * p.unknowns;
    double sum = 0;
    for (uint d = lane; d < p.unknowns; d += lanes) sum += y.data[at + d] * du.data[d];
    const double length_ = a.data[slot] - part_sum(sum) / s_y.data[slot];
    for (uint d = lane; d < p.unknowns; d += lanes) du.data[d] += length_ * s.data[at + d];
  }
}
