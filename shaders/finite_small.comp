#version 460
// SPDX-License-Identifier: Apache-2.0
// c = M x at the unknowns that what has left touches (core/solver/finite_base.hpp).
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

IN_DOUBLES(0, Small, m)
IN_WORDS(1, Touched, touched)
IN_DOUBLES(2, Made, x)
OUT(3, Coefficients, double, c)
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  const uint i = invocation();
  if (i >= p.rank) return;
  double sum = 0;
  for (uint j = 0u; j < p.rank; ++j) sum += m.data[j * p.rank + i] * x.data[touched.data[j]];
  c.data[i] = sum;
}
