#version 460
// SPDX-License-Identifier: Apache-2.0
// What an event changes of the small matrices (core/solver/damage_solver.hpp): [T S] += W^T [V W], or
// -=, an invocation a value; where columns of B are new there was nothing, and rows of G get the new
// columns' values by symmetry.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DOUBLES(0, Vectors, vectors)  // V and W side by side, a row a vector
INOUT(1, Forces, double, ts)     // columns of T, then of S
INOUT(2, Compliance, double, g)
layout(push_constant) uniform Push { DamageFollowPush p; };

void main() {
  const uint i = invocation(), j = gl_WorkGroupID.y;
  if (i >= p.columns) return;
  const uint width = p.grips + p.columns;
  const bool of_s = j >= p.grips;
  const uint column = of_s ? j - p.grips : 0u, at = j * p.rows + i;
  double value = i >= p.first || column >= p.first ? 0.0 : ts.data[at];
  for (uint k = 0u; k < p.rank; ++k) {
    const uint at_k = p.vectors + k * width;
    const double term = vectors.data[at_k + p.grips + i] * vectors.data[at_k + j];
    value = p.subtract != 0u ? value - term : value + term;
  }
  ts.data[at] = value;
  if (of_s && column < p.first_compliance && i >= p.first_compliance) {
    g.data[column * p.rows + i] = g.data[i * p.rows + column];
  }
}
