// SPDX-License-Identifier: Apache-2.0
// Products with 6 x 6 blocks between groups of nodes (gpu/passes/rigid_levels.hpp): in fp32, quarter by
// quarter, with the number of the column behind; sums in fp64. Products in fp32 take half the time and
// up to 100 iterations more, for what they round differs from one to the next.
const uint kSixPacks = kSixWords / 4u;

struct Six {
  dvec3 shift, turn;
};

// Of six values a group.
#define SIX_OF_GROUP(name, g)                                                             \
  six_of(UVEC4(name, 3u * (g)), UVEC4(name, 3u * (g) + 1u), UVEC4(name, 3u * (g) + 2u))
Six six_of(uvec4 a, uvec4 b, uvec4 c) {
  return Six(dvec3(packDouble2x32(a.xy), packDouble2x32(a.zw), packDouble2x32(b.xy)),
             dvec3(packDouble2x32(b.zw), packDouble2x32(c.xy), packDouble2x32(c.zw)));
}

// The nine packs of a block.
struct SixBlock {
  vec4 a, b, c, d, e, f, g, h, i;
};
#define SIX_BLOCK(name, at)                                                                        \
  SixBlock(uintBitsToFloat(UVEC4(name, at)), uintBitsToFloat(UVEC4(name, (at) + 1u)),              \
           uintBitsToFloat(UVEC4(name, (at) + 2u)), uintBitsToFloat(UVEC4(name, (at) + 3u)),       \
           uintBitsToFloat(UVEC4(name, (at) + 4u)), uintBitsToFloat(UVEC4(name, (at) + 5u)),       \
           uintBitsToFloat(UVEC4(name, (at) + 6u)), uintBitsToFloat(UVEC4(name, (at) + 7u)),       \
           uintBitsToFloat(UVEC4(name, (at) + 8u)))
#define SIX_COLUMN(name, at) UVEC4(name, (at) + 9u).x

dvec3 of_quarter(vec3 row0, vec3 row1, vec3 row2, dvec3 v) {
  return dvec3(dot(dvec3(row0), v), dot(dvec3(row1), v), dot(dvec3(row2), v));
}

void add_product(inout Six sum, SixBlock m, Six v) {
  sum.shift += of_quarter(m.a.xyz, vec3(m.a.w, m.b.xy), vec3(m.b.zw, m.c.x), v.shift);
  sum.shift += of_quarter(m.c.yzw, m.d.xyz, vec3(m.d.w, m.e.xy), v.turn);
  sum.turn += of_quarter(vec3(m.e.zw, m.f.x), m.f.yzw, m.g.xyz, v.shift);
  sum.turn += of_quarter(vec3(m.g.w, m.h.xy), vec3(m.h.zw, m.i.x), m.i.yzw, v.turn);
}
