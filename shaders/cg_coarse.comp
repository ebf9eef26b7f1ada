#version 460
// SPDX-License-Identifier: Apache-2.0
// w = (Z^T K Z)^-1 y, and y_i w_i behind it.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Inverse { double data[]; } inverse_;
layout(std430, set = 0, binding = 1) readonly buffer Y { double data[]; } y;
OUT(2, W, double, w)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  double sum = 0;
  // Symmetric: a column for the row, so that neighbours read neighbours.
  for (uint j = 0u; j < 6u * p.rigid_groups; ++j) {
    sum += inverse_.data[j * 6u * kRigidGroups + i] * y.data[j];
  }
  if (i < 6u * p.rigid_groups) {
    w.data[i] = sum;
    w.data[kRigidTerms + i] = sum * y.data[i];
  }
}
