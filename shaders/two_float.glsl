// SPDX-License-Identifier: Apache-2.0
// Numbers of some 48 bits as two floats, for devices without shaderFloat64: high part and the rest,
// interleaved, so that a number takes the eight bytes of an fp64 one. Sums by Knuth, products by Dekker
// (Numer. Math. 18, 1971): fma() need not be fused.
struct Two3 {
  vec3 high, low;
};

Two3 two_sum(vec3 a, vec3 b) {
  precise const vec3 sum = a + b;
  precise const vec3 of_b = sum - a;
  precise const vec3 rest = (a - (sum - of_b)) + (b - of_b);
  return Two3(sum, rest);
}

Two3 minus(Two3 a, Two3 b) {
  const Two3 s = two_sum(a.high, -b.high);
  precise const vec3 low = s.low + (a.low - b.low);
  return Two3(s.high, low);
}

Two3 plus(Two3 a, Two3 b) {
  const Two3 s = two_sum(a.high, b.high);
  precise const vec3 low = s.low + (a.low + b.low);
  return Two3(s.high, low);
}

Two3 times(Two3 a, vec2 b) {  // b: high, low
  precise const vec3 big = 4097.0 * a.high;
  precise const vec3 a_1 = big - (big - a.high);
  precise const vec3 a_2 = a.high - a_1;
  precise const float big_b = 4097.0 * b.x;
  precise const float b_1 = big_b - (big_b - b.x);
  precise const float b_2 = b.x - b_1;
  precise const vec3 product = a.high * b.x;
  precise const vec3 rest = a_2 * b_2 - (((product - a_1 * b_1) - a_2 * b_1) - a_1 * b_2);
  precise const vec3 low = rest + (a.high * b.y + a.low * b.x);
  return Two3(product, low);
}

// Of two texels: (x, x', y, y'), (z, z', w, w').
Two3 two3(vec4 a, vec4 b) { return Two3(vec3(a.xz, b.x), vec3(a.yw, b.y)); }
