// SPDX-License-Identifier: Apache-2.0
// An element's deformation and its polar decomposition. The formulas are those of
// core/material/lanes.hpp; where R is not to be had so, by Jacobi's rotations of F^T F.
#include "finite.glsl"

IN_DOUBLES(0, Nodal, u)
layout(std430, set = 0, binding = 1) readonly buffer Nodes { uvec4 data[]; } nodes;
IN_DOUBLES(2, Shape, shape)
IN_WORDS(3, Facts, facts)
#ifndef SUNDER_ELASTIC
IN_DOUBLES(4, From, from)  // of the viscous strain: (xx, yy, zz, xy, yz, zx)
#endif

uint law_of(uint fact) { return fact / kFiniteLaw % kFiniteLaws; }

// m about 1 with x = 2^k m.
double about_one(double x, out int k) {
  const uvec2 bits = unpackDouble2x32(x);
  k = int(bits.y >> 20u) - 1023;
  const double m = packDouble2x32(uvec2(bits.x, (bits.y & 0x000fffffu) | 0x3ff00000u));
  if (!(m > 1.4142135623730951LF)) return m;
  k += 1;
  return 0.5LF * m;
}

// Cube root of x > 0, as lanes::cube_root: x = 2^(3 q + r) m, Halley's step twice.
double cube_root_(double x) {
  int k;
  const double m = about_one(x, k);
  const int q = (k + (k > 0 ? 1 : -1)) / 3, r = k - 3 * q;
  const double f = m - 1.0LF;
  double root = 1.0LF + f * (1.0LF / 3.0LF - f * (1.0LF / 9.0LF));
  [[unroll]] for (int step = 0; step < 2; ++step) {
    const double cube = root * root * root;
    root += root * ((m - cube) / (2.0LF * cube + m));
  }
  const double part = r > 0 ? 1.2599210498948732LF : r < 0 ? 0.79370052598409974LF : 1.0LF;
  return root * (part * packDouble2x32(uvec2(0u, uint(q + 1023) << 20u)));
}

// Below it a ratio of volumes counts as none.
const double kLeastVolume = 2.2250738585072014e-308LF;

// Natural logarithm of x > 0, as lanes::log.
double log_(double x) {
  int k;
  const double m = about_one(x, k);
  const double f = m - 1.0LF, z = f / (2.0LF + f), zz = z * z;
  double series = 2.0LF / 23.0LF;
  [[unroll]] for (int n = 21; n >= 3; n -= 2) series = series * zz + 2.0LF / double(n);
  const double rest = z * (f - series * zz);
  return double(k) * 0.693147180369123816490LF -
         ((rest - double(k) * 1.90821492927058770002e-10LF) - f);
}

// GLSL's matrices are by columns: m[j][i] is row i, column j.
dmat3 cofactor(dmat3 f) {
  return dmat3(cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1]));
}

struct Polar {
  dmat3 r;
  double trace;  // of S
};

// One of Jacobi's rotations: the columns a and b of B = F V become normal to each other.
void rotate(inout dvec3 a, inout dvec3 b, inout dvec3 va, inout dvec3 vb) {
  const double across = dot(a, b), first = dot(a, a), second = dot(b, b);
  if (!(abs(across) > 1e-17LF * sqrt(first * second))) return;
  const double tau = (second - first) / (2.0LF * across);
  const double t = (tau >= 0.0LF ? 1.0LF : -1.0LF) / (abs(tau) + sqrt(1.0LF + tau * tau));
  const double c = 1.0LF / sqrt(1.0LF + t * t), s = c * t;
  const dvec3 keep = a, keep_v = va;
  a = c * keep - s * b;
  b = s * keep + c * b;
  va = c * keep_v - s * vb;
  vb = s * keep_v + c * vb;
}

// F = R S by F V = U diag(s), the smallest s with the sign of det F.
Polar by_jacobi(dmat3 f) {
  dmat3 v = dmat3(1.0LF), b = f;
  for (int sweep = 0; sweep < 8; ++sweep) {
    rotate(b[0], b[1], v[0], v[1]);
    rotate(b[1], b[2], v[1], v[2]);
    rotate(b[2], b[0], v[2], v[0]);
  }
  dvec3 s = dvec3(length(b[0]), length(b[1]), length(b[2]));
  // The two largest first, in turn, so that V stays a rotation.
  for (int turn = 0; turn < 2 && !(s[2] <= s[0] && s[2] <= s[1]); ++turn) {
    s = s.yzx;
    b = dmat3(b[1], b[2], b[0]);
    v = dmat3(v[1], v[2], v[0]);
  }
  const bool swap = s[1] > s[0];
  const dvec3 b0 = swap ? b[1] : b[0], b1 = swap ? b[0] : b[1];
  const dvec3 v0 = swap ? v[1] : v[0], v1 = swap ? v[0] : v[1];
  const double s0 = length(b0);
  const dvec3 u0 = s0 > 0.0LF ? b0 / s0 : dvec3(1, 0, 0);
  dvec3 rest = b1 - dot(b1, u0) * u0;
  double size = length(rest);
  if (!(size > 1e-300LF)) {  // one direction is left: any that is normal to it
    rest = abs(u0.x) < 0.5LF ? cross(u0, dvec3(1, 0, 0)) : cross(u0, dvec3(0, 1, 0));
    size = length(rest);
  }
  const dvec3 u1 = rest / size, u2 = cross(u0, u1), v2 = cross(v0, v1);
  Polar found;
  found.r = outerProduct(u0, v0) + outerProduct(u1, v1) + outerProduct(u2, v2);
  found.trace = s0 + dot(u1, b1) + dot(u2, f * v2);
  return found;
}

// R from the largest root of Horn's quartic (lanes.hpp).
Polar polar(dmat3 f, dmat3 c, double volume) {
  const double e = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2]);
  const double k = dot(c[0], c[0]) + dot(c[1], c[1]) + dot(c[2], c[2]);
  const double pairs = sqrt((volume > 0.0LF ? 3.0LF : 1.0LF) * k);
  double t = sqrt(e + 2.0LF * pairs), open = 1.0LF;
  for (int i = 0; i < 12 && !(open <= 0.0LF); ++i) {
    const double w = t * t - e, slope = t * w - 2.0LF * volume;
    const double move = 0.25LF * ((w * w - 8.0LF * volume * t) - 4.0LF * k) / slope;
    t -= move;
    open = abs(move) * e - 1e-8LF * slope;
  }
  const double by = t * (t * t - e) - 2.0LF * volume;
  if (!(open <= 0.0LF) || !(0.1LF * e * t - by <= 0.0LF)) return by_jacobi(f);
  Polar found;
  found.r = ((t * t + e) * f + 2.0LF * t * c - 2.0LF * (f * (transpose(f) * f))) / by;
  found.trace = t;
  return found;
}

double inner(dmat3 a, dmat3 b) { return dot(a[0], b[0]) + dot(a[1], b[1]) + dot(a[2], b[2]); }
dmat3 symmetric(dmat3 a) { return 0.5LF * (a + transpose(a)); }
dmat3 green(dmat3 f) { return 0.5LF * (transpose(f) * f - dmat3(1.0LF)); }
// 2 mu e + lambda tr e I.
dmat3 hooke(dmat3 e, double mu, double lambda) {
  return 2.0LF * mu * e + lambda * (e[0][0] + e[1][1] + e[2][2]) * dmat3(1.0LF);
}

dvec3 at_node(uint n) {
  return dvec3(u.data[3u * n], u.data[3u * n + 1u], u.data[3u * n + 2u]);
}

// grad u, from differences to corner 0.
dmat3 gradient(uint e) {
  const uvec4 n = nodes.data[e];
  const dvec3 u0 = at_node(n.x);
  const dvec3 d1 = at_node(n.y) - u0, d2 = at_node(n.z) - u0, d3 = at_node(n.w) - u0;
  const uint at = kFiniteShape * e;
  dmat3 h;
  [[unroll]] for (uint j = 0u; j < 3u; ++j) {
    h[j] = d1 * shape.data[at + j] + d2 * shape.data[at + 3u + j] + d3 * shape.data[at + 6u + j];
  }
  return h;
}

#ifndef SUNDER_ELASTIC
// Strain since the step began, which viscous stress resists.
dmat3 viscous_way(uint e, uint law, dmat3 h) {
  dmat3 way = symmetric(h);
  if (law != 0u) way += 0.5LF * (transpose(h) * h);
  const uint at = 6u * e;
  const double xy = from.data[at + 3u], yz = from.data[at + 4u], zx = from.data[at + 5u];
  return way - dmat3(dvec3(from.data[at], xy, zx), dvec3(xy, from.data[at + 1u], yz),
                     dvec3(zx, yz, from.data[at + 2u]));
}
#endif
