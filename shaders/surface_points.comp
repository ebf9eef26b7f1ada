#version 460
// SPDX-License-Identifier: Apache-2.0
// Places of nodes and their unit normals, weighted by area, in fp32 for a host. A node gathers from the
// elements around it, in the order of their ids: no atomics, the same bits every time.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "surface.glsl"

IN_WORDS(3, First, first)  // of each node of the mesh: where its elements begin in `around`
IN_WORDS(4, Around, around)
IN_UVEC4(5, Corners, corners)
IN_WORDS(6, Shows, shows)
OUT(7, Places, float, places)
OUT(8, Normals, float, normals)
layout(push_constant) uniform Push { SurfacePointsPush p; };

// Corners opposite to each corner, anticlockwise seen from outside.
const uvec3 kOpposite[4] = uvec3[4](uvec3(1, 2, 3), uvec3(0, 3, 2), uvec3(0, 1, 3), uvec3(0, 2, 1));

EDGE area(uvec4 c, uint opposite) {
  const uvec3 of = kOpposite[opposite];
  const PLACE a = place_of(c[of.x]);
  return cross(edge(a, place_of(c[of.y])), edge(a, place_of(c[of.z])));
}

void main() {
  const uint n = invocation();
  if (n >= p.count) return;
  if (p.places_stride != 0u) {
    const vec3 at = rounded(place_of(n));
    const uint to = p.places_at + n * p.places_stride;
    for (uint i = 0u; i < 3u; ++i) places.data[to + i] = at[i];
  }
  if (p.others_stride == 0u) return;
  EDGE sum = EDGE(0);
  const uint from = parents.data[n];
  for (uint k = first.data[from]; k < first.data[from + 1u]; ++k) {
    const uint e = around.data[k];
    const uint faces = shows.data[e];
    if ((faces & 15u) == 0u) continue;
    const uvec4 c = UVEC4(corners, e);
    if (all(notEqual(c, uvec4(n)))) continue;  // it holds another node that has parted here
    for (uint f = 0u; f < 4u; ++f) {
      if ((faces >> f & 1u) != 0u && c[f] != n) sum += area(c, f);
    }
  }
  const EDGE normal = dot(sum, sum) > 0 ? normalize(sum) : EDGE(0);
  const uint to = p.others_at + n * p.others_stride;
  for (uint i = 0u; i < 3u; ++i) normals.data[to + i] = float(normal[i]);
}
