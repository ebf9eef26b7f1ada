#version 460
// SPDX-License-Identifier: Apache-2.0
// Vertices of a fine mesh, each carried by an element: its corners' places times barycentric coordinates.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "surface.glsl"

IN_UVEC4(3, Corners, corners)
IN_WORDS(4, Shows, shows)
IN_WIDE4(5, Shares, shares)
IN_WORDS(6, Carriers, carriers)
OUT(7, Places, float, places)
OUT(8, Lives, uint, lives)
layout(push_constant) uniform Push { SurfacePointsPush p; };

#ifdef SUNDER_SINGLE
Two3 carried(uint v, uvec4 c) {
  const vec4 a = VEC4(shares, 2u * v), b = VEC4(shares, 2u * v + 1u);
  return plus(plus(times(place_of(c.x), a.xy), times(place_of(c.y), a.zw)),
              plus(times(place_of(c.z), b.xy), times(place_of(c.w), b.zw)));
}
#else
dvec3 carried(uint v, uvec4 c) {
  const dvec4 share = DVEC4(shares, v);
  return share.x * place_of(c.x) + share.y * place_of(c.y) + share.z * place_of(c.z) +
         share.w * place_of(c.w);
}
#endif

void main() {
  const uint v = invocation();
  if (v >= p.count) return;
  const uint e = carriers.data[v];
  if (p.places_stride != 0u) {
    const vec3 at = rounded(carried(v, UVEC4(corners, e)));
    const uint to = p.places_at + v * p.places_stride;
    for (uint i = 0u; i < 3u; ++i) places.data[to + i] = at[i];
  }
  if (p.others_stride != 0u) {
    lives.data[p.others_at + v * p.others_stride] = (shows.data[e] & kGone) == 0u ? 1u : 0u;
  }
}
