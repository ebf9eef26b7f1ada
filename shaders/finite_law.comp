#version 460
// SPDX-License-Identifier: Apache-2.0
// Of every element: internal forces V P grad N and viscous ones on its corners, its stress, energy, and how
// far its stress is from that of another state. The formulas are those of core/material/lanes.hpp; where R
// is not to be had so, by Jacobi's rotations of F^T F.
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

IN_DOUBLES(0, Nodal, u)
layout(std430, set = 0, binding = 1) readonly buffer Nodes { uvec4 data[]; } nodes;
IN_DOUBLES(2, Shape, shape)
IN_WORDS(3, Facts, facts)
IN_DOUBLES(4, Before, before)  // stress of the other state, six an element
IN_DOUBLES(5, From, from)      // of the viscous strain: (xx, yy, zz, xy, yz, zx)
OUT(6, Corners, double, corners)
OUT(7, ViscousCorners, double, viscous_corners)
OUT(8, Stress, double, stress)
OUT(9, Partials, FiniteElementPartial, partials)
layout(push_constant) uniform Push { FinitePush p; };

// Natural logarithm of x > 0, as lanes::log.
double log_(double x) {
  const uvec2 bits = unpackDouble2x32(x);
  int k = int(bits.y >> 20u) - 1023;
  double m = packDouble2x32(uvec2(bits.x, (bits.y & 0x000fffffu) | 0x3ff00000u));
  if (m > 1.4142135623730951LF) {
    m *= 0.5LF;
    k += 1;
  }
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
double squared(dvec3 normal, dvec3 shear) {
  return dot(normal, normal) + 2.0LF * dot(shear, shear);
}

void leave(double energy, double viscous, double stress_squared, double change_squared) {
  energy = part_sum(energy);
  viscous = part_sum(viscous);
  stress_squared = part_max(stress_squared);
  change_squared = part_max(change_squared);
  if (leads_part()) {
    partials.data[part()] = FiniteElementPartial(energy, viscous, stress_squared, change_squared);
  }
}

void put(uint e, dmat3 p_, bool viscous) {
  dvec3 sum = dvec3(0);
  for (uint corner = 0u; corner < 3u; ++corner) {
    const uint at = kFiniteShape * e + 3u * corner;
    const dvec3 g = dvec3(shape.data[at], shape.data[at + 1u], shape.data[at + 2u]);
    const dvec3 force = p_ * g;
    sum += force;
    const uint to = 12u * e + 3u * corner + 3u;
    [[unroll]] for (uint i = 0u; i < 3u; ++i) {
      if (viscous) viscous_corners.data[to + i] = force[i];
      else corners.data[to + i] = force[i];
    }
  }
  [[unroll]] for (uint i = 0u; i < 3u; ++i) {
    if (viscous) viscous_corners.data[12u * e + i] = -sum[i];
    else corners.data[12u * e + i] = -sum[i];
  }
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

struct Response {
  double energy;
  dmat3 p;
};

Response respond(uint law, double mu, double lambda, dmat3 f, dmat3 c, double volume, Polar of) {
  Response found;
  if (law == 0u) {
    const dmat3 e = symmetric(f) - dmat3(1.0LF);
    const double trace = e[0][0] + e[1][1] + e[2][2];
    found.energy = mu * inner(e, e) + 0.5LF * lambda * trace * trace;
    found.p = 2.0LF * mu * e + lambda * trace * dmat3(1.0LF);
  } else if (law == 1u) {
    const dmat3 apart = f - of.r;
    const double dilation = of.trace - 3.0LF, pressure = lambda * dilation;
    found.energy = mu * inner(apart, apart) + 0.5LF * pressure * dilation;
    found.p = 2.0LF * mu * apart + pressure * of.r;
  } else if (law == 2u) {
    const double dilation = volume > 0.0LF ? log_(volume) : 0.0LF, pressure = lambda * dilation;
    found.energy = volume > 0.0LF ? (0.5LF * mu * (inner(f, f) - 3.0LF) - mu * dilation) +
                                        0.5LF * pressure * dilation
                                  : infinity();
    found.p = mu * f + ((pressure - mu) / volume) * c;
  } else {
    const dmat3 e = 0.5LF * (transpose(f) * f - dmat3(1.0LF));
    const double trace = e[0][0] + e[1][1] + e[2][2];
    found.energy = mu * inner(e, e) + 0.5LF * lambda * trace * trace;
    found.p = f * (2.0LF * mu * e + lambda * trace * dmat3(1.0LF));
  }
  return found;
}

// Potential of the viscous stress, whose forces are left at the corners.
double resist(uint e, uint law, dmat3 h, double volume, double mu, double lambda) {
  dmat3 way = symmetric(h);
  if (law != 0u) way += 0.5LF * (transpose(h) * h);
  const uint at = 6u * e;
  const double xy = from.data[at + 3u], yz = from.data[at + 4u], zx = from.data[at + 5u];
  way -= dmat3(dvec3(from.data[at], xy, zx), dvec3(xy, from.data[at + 1u], yz),
               dvec3(zx, yz, from.data[at + 2u]));
  const double trace = way[0][0] + way[1][1] + way[2][2];
  dmat3 s = (2.0LF * mu * way + lambda * trace * dmat3(1.0LF)) * (p.viscous * volume);
  const double potential = 0.5LF * inner(s, way);
  if (law != 0u) s += h * s;
  put(e, s, true);
  return potential;
}

void main() {
  const uint e = gl_GlobalInvocationID.x;
  double energy = 0, viscous = 0, stress_squared = 0, change_squared = 0;
  const uint fact = e < p.elements ? facts.data[e] : kFiniteOut;
  if (e < p.elements && (fact & kFiniteOut) != 0u) {
    put(e, dmat3(0.0LF), false);
    if (p.viscous > 0.0LF) put(e, dmat3(0.0LF), true);
    [[unroll]] for (uint i = 0u; i < 6u; ++i) stress.data[6u * e + i] = 0.0LF;
  } else if (e < p.elements) {
    const uint law = fact / kFiniteLaw, at = kFiniteShape * e;
    const double volume = shape.data[at + 9u], mu = shape.data[at + 10u],
                 lambda = shape.data[at + 11u];
    const dmat3 h = gradient(e);
    const dmat3 f = dmat3(1.0LF) + h, c = cofactor(f);
    const double j = dot(f[0], c[0]);
    Polar of;
    if (law == 1u || p.biot != 0u) of = polar(f, c, j);
    const Response found = respond(law, mu, lambda, f, c, j, of);
    const bool acts = !isinf(found.energy) && !isnan(found.energy);
    energy = volume * found.energy;
    put(e, acts ? volume * found.p : dmat3(0.0LF), false);
    const dmat3 s = p.biot != 0u ? symmetric(transpose(of.r) * found.p)
                                 : symmetric(found.p * transpose(f)) * (1.0LF / j);
    const double none = found.energy - found.energy;
    const dvec3 normal = dvec3(s[0][0], s[1][1], s[2][2]) + none,
                shear = dvec3(s[1][0], s[2][1], s[0][2]) + none;
    const uint to = 6u * e;
    dvec3 normal_before, shear_before;
    [[unroll]] for (uint i = 0u; i < 3u; ++i) {
      normal_before[i] = before.data[to + i];
      shear_before[i] = before.data[to + 3u + i];
      stress.data[to + i] = normal[i];
      stress.data[to + 3u + i] = shear[i];
    }
    stress_squared = bounded(squared(normal_before, shear_before));
    change_squared = bounded(squared(normal - normal_before, shear - shear_before));
    if (p.viscous > 0.0LF) viscous = resist(e, law, h, volume, mu, lambda);
  }
  leave(energy, viscous, stress_squared, change_squared);
}
