#version 460
// SPDX-License-Identifier: Apache-2.0
// One workgroup: the first loop of L-BFGS (core/solver/lbfgs.hpp), from -r to what the base is applied to.
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

IN_DOUBLES(0, Residual, r)
IN_DOUBLES(1, Steps, s)
IN_DOUBLES(2, Changes, y)
IN_DOUBLES(3, Products, s_y)  // of each slot
OUT(4, Lengths, double, a)
layout(std430, set = 0, binding = 5) buffer Q { double data[]; } q;
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  const uint lane = gl_LocalInvocationID.x, lanes = gl_WorkGroupSize.x;
  for (uint d = lane; d < p.unknowns; d += lanes) q.data[d] = -r.data[d];
  for (uint k = p.pairs; k-- > 0u;) {
    const uint slot = (p.order >> (4u * k)) & 15u, at = slot * p.unknowns;
    double sum = 0;
    for (uint d = lane; d < p.unknowns; d += lanes) sum += s.data[at + d] * q.data[d];
    const double length_ = part_sum(sum) / s_y.data[slot];
    if (lane == 0u) a.data[slot] = length_;
    for (uint d = lane; d < p.unknowns; d += lanes) q.data[d] -= length_ * y.data[at + d];
  }
}
