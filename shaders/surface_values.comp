#version 460
// SPDX-License-Identifier: Apache-2.0
// What a host colours the triangles of a surface by, in fp32: maximum shear stress, ratio to yield, largest
// strain and displacement of the element that each is of.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "principal.glsl"
#include "surface.glsl"

IN_UVEC4(3, Corners, corners)
IN_WORDS(4, Elements, elements)  // of triangles
IN_REAL4(5, Stress, stress)      // as stress.glsl leaves it; kOfHost: (0, 0, maximum shear, ratio)
OUT(6, Values, float, values)
layout(push_constant) uniform Push { SurfaceValuesPush p; };

float max_shear(REAL4 a, REAL4 b) {
  if (p.measure == 0u) return float(b.z);
  if (p.measure == 1u) return float(b.z / REAL(2));
  return float(principal(a.xyz, REAL3(a.w, b.x, b.y)).range / REAL(2));
}

vec2 stress_of(uint e) {
  if (p.stress == kOfHost) return vec2(LOAD_REAL4(stress, e).zw);
  if (p.stress == kNoStress) return vec2(0);
  const REAL4 a = LOAD_REAL4(stress, 2u * e), b = LOAD_REAL4(stress, 2u * e + 1u);
  return vec2(max_shear(a, b), float(b.w));
}

EDGE rest_edge(uint from, uint to) { return edge(rest_of(from), rest_of(to)); }
EDGE moved_edge(uint from, uint to) { return edge(moved_of(from), moved_of(to)); }

// Largest principal value by magnitude, without its sign: of sym grad u, or of U - I. With the principal
// values g of Green's strain those of U - I are sqrt(1 + 2 g) - 1. What a loose part turns by cancels in
// strain, which is rounded after that.
float largest_strain(uvec4 c) {
  const EDGE x = rest_edge(c.x, c.y), y = rest_edge(c.x, c.z), z = rest_edge(c.x, c.w);
  const EDGE yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
  const EDGE u = moved_edge(c.x, c.y), v = moved_edge(c.x, c.z), w = moved_edge(c.x, c.w);
  // Rows of grad u, times the determinant.
  const EDGE gx = u.x * yz + v.x * zx + w.x * xy, gy = u.y * yz + v.y * zx + w.y * xy,
             gz = u.z * yz + v.z * zx + w.z * xy;
  const EDGE hx = gx / dot(x, yz), hy = gy / dot(x, yz), hz = gz / dot(x, yz);
  EDGE normal = EDGE(hx.x, hy.y, hz.z);
  EDGE twice_shear = EDGE(hx.y + hy.x, hy.z + hz.y, hz.x + hx.z);
  if (p.finite != 0u) {
    normal += (hx * hx + hy * hy + hz * hz) / 2;
    twice_shear += hx.xyz * hx.yzx + hy.xyz * hy.yzx + hz.xyz * hz.yzx;
  }
  const Principal found = principal(REAL3(normal), REAL3(twice_shear / 2));
  vec2 ends = vec2(float(found.largest), found.least);
  if (p.finite != 0u) ends = 2.0 * ends / (1.0 + sqrt(max(1.0 + 2.0 * ends, 0.0)));
  return max(abs(ends.x), abs(ends.y));
}

float largest_displacement(uvec4 c) {
  float largest = 0.0;
  [[unroll]] for (uint i = 0u; i < 4u; ++i) largest = max(largest, length(rounded(moved_of(c[i]))));
  return largest;
}

void main() {
  const uint t = invocation();
  if (t >= p.count) return;
  const uint e = elements.data[t];
  if (e == kHeld) return;  // nothing has this place now
  const uvec4 c = UVEC4(corners, e);
  const vec2 of_stress = stress_of(e);
  const uint to = p.values_at + t * p.values_stride;
  values.data[to] = of_stress.x;
  values.data[to + 1u] = of_stress.y;
  values.data[to + 2u] = largest_strain(c);
  values.data[to + 3u] = largest_displacement(c);
}
