// SPDX-License-Identifier: Apache-2.0
// Conjugate gradients on a tangent that is kept element by element: its upper triangle, column by
// column, in packs of four. Whoever includes this binds it as `tangents`.
#include "cg.glsl"

IN_REAL4(0, Tangents, tangents)
IN_DOUBLES(1, Shape, shape)
layout(push_constant) uniform Push { FiniteCgPush p; };

const uint kTriangle = 45u;
struct Tangent {
  double upper[4u * kFiniteTangent];
};

Tangent load(uint e) {
  Tangent of;
  [[unroll]] for (uint k = 0u; k < kFiniteTangent; ++k) {
    const dvec4 four = dvec4(LOAD_REAL4(tangents, k * p.elements + e));
    [[unroll]] for (uint i = 0u; i < 4u; ++i) of.upper[4u * k + i] = four[i];
  }
  return of;
}

// grad N of a corner.
dvec3 slope(uint e, uint corner) {
  const uint at = kFiniteShape * e;
  if (corner > 0u) {
    const uint from = at + 3u * (corner - 1u);
    return dvec3(shape.data[from], shape.data[from + 1u], shape.data[from + 2u]);
  }
  dvec3 sum = dvec3(0);
  [[unroll]] for (uint i = 0u; i < 3u; ++i) {
    sum -= dvec3(shape.data[at + 3u * i], shape.data[at + 3u * i + 1u], shape.data[at + 3u * i + 2u]);
  }
  return sum;
}
