// SPDX-License-Identifier: Apache-2.0
// Where nodes of a surface are, for kernels that write it to a host's buffers.
#include "two_float.glsl"

IN_WIDE4(0, Nodal, u)
IN_WIDE4(1, Rest, rest)          // of the mesh's nodes
IN_WORDS(2, Parents, parents)    // of every node: the mesh's at which it lies undeformed

#ifdef SUNDER_SINGLE
#define PLACE Two3
#define EDGE vec3
Two3 rest_of(uint n) {
  const uint from = parents.data[n];
  return two3(VEC4(rest, 2u * from), VEC4(rest, 2u * from + 1u));
}
Two3 moved_of(uint n) { return two3(VEC4(u, 2u * n), VEC4(u, 2u * n + 1u)); }
Two3 place_of(uint n) { return plus(rest_of(n), moved_of(n)); }
vec3 edge(Two3 from, Two3 to) {
  const Two3 d = minus(to, from);
  return d.high + d.low;
}
vec3 rounded(Two3 a) { return a.high + a.low; }
#else
#define PLACE dvec3
#define EDGE dvec3
dvec3 rest_of(uint n) { return DVEC4(rest, parents.data[n]).xyz; }
dvec3 moved_of(uint n) { return DVEC4(u, n).xyz; }
dvec3 place_of(uint n) { return rest_of(n) + moved_of(n); }
dvec3 edge(dvec3 from, dvec3 to) { return to - from; }
vec3 rounded(dvec3 a) { return vec3(a); }
#endif
