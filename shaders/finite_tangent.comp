#version 460
// SPDX-License-Identifier: Apache-2.0
// Of every element: V dP/dF at a state, viscous stress included; the upper triangle of nine by nine, F by
// columns, in packs of four (finite_cg.glsl).
#extension GL_GOOGLE_include_directive : require
#include "finite_laws.glsl"
#define FIBRES_AT 6
#include "finite_fibres.glsl"

OUT(5, Tangents, REAL, tangents)
layout(push_constant) uniform Push { FinitePush p; };

struct At {
  uint law;
  double mu, lambda;
  dmat3 f, normal;  // F^-T
  double pressure;  // neo-Hookean: lambda ln J
  Polar polar_;
  dmat3 turns;  // corotated: (tr S I - S)^-1
  dmat3 stress, viscous;  // second Piola-Kirchhoff
};

// dP for dF (P's gradient by hand: of R by R^T dR = [w], (tr S I - S) w = axial of R^T dF - dF^T R).
dmat3 change(At at, dmat3 d) {
  if (at.law == 0u) return hooke(symmetric(d), at.mu, at.lambda);
  if (at.law == 1u) {
    const dmat3 r = at.polar_.r, m = transpose(r) * d;
    const dvec3 w =
        at.turns * dvec3(m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]);
    const dmat3 dr =
        r * dmat3(dvec3(0, w.z, -w.y), dvec3(-w.z, 0, w.x), dvec3(w.y, -w.x, 0));
    return 2.0LF * at.mu * (d - dr) + at.lambda * ((m[0][0] + m[1][1] + m[2][2]) * r +
                                                   (at.polar_.trace - 3.0LF) * dr);
  }
  if (at.law == 2u) {
    return at.mu * d + at.lambda * inner(at.normal, d) * at.normal +
           (at.mu - at.pressure) * (at.normal * transpose(d) * at.normal);
  }
  return d * at.stress + at.f * hooke(symmetric(transpose(at.f) * d), at.mu, at.lambda);
}

// Of the viscous stress, its factor included.
dmat3 change_of_viscous(At at, dmat3 d) {
  if (at.law == 0u) return p.viscous * hooke(symmetric(d), at.mu, at.lambda);
  return d * at.viscous +
         p.viscous * (at.f * hooke(symmetric(transpose(at.f) * d), at.mu, at.lambda));
}

// Of one family: d(2 W' F A) = W'' (2 F A)(2 F A : dF) + 2 W' dF A.
struct FamilyAt {
  dmat3 structure, slope;  // A, 2 F A
  double first, second;    // W', W''
};
FamilyAt family_at(uint e, uint i, dmat3 f, dmat3 h) {
  const Family of = family_of(e, i);
  const double along = stretched(of, h), exponent = of.k2 * along * along;
  FamilyAt at;
  at.structure = structure(of);
  at.slope = 2.0LF * (f * at.structure);
  const double growth = along > 0.0LF && exponent <= 100.0LF ? of.k1 * exp_(exponent) : 0.0LF;
  at.first = growth * along;
  at.second = growth * (1.0LF + 2.0LF * exponent);
  return at;
}
dmat3 change_of_fibres(FamilyAt at, dmat3 d) {
  return at.second * inner(at.slope, d) * at.slope + 2.0LF * at.first * (d * at.structure);
}

void main() {
  const uint e = invocation();
  if (e >= p.elements) return;
  const uint fact = facts.data[e];
  if ((fact & kFiniteOut) != 0u) {
    for (uint k = 0u; k < 4u * kFiniteTangent; ++k) {
      tangents.data[4u * (k / 4u * p.elements + e) + k % 4u] = REAL(0);
    }
    return;
  }
  const uint shape_at = kFiniteShape * e;
  const double volume = shape.data[shape_at + 9u];
  At at;
  at.law = law_of(fact);
  at.mu = shape.data[shape_at + 10u];
  at.lambda = shape.data[shape_at + 11u];
  const dmat3 h = gradient(e);
  at.f = dmat3(1.0LF) + h;
  const dmat3 c = cofactor(at.f);
  const double j = dot(at.f[0], c[0]);
  if (at.law == 1u) {
    at.polar_ = polar(at.f, c, j);
    const dmat3 s = transpose(at.polar_.r) * at.f, g = at.polar_.trace * dmat3(1.0LF) - s,
                of_g = cofactor(g);
    const double size = dot(g[0], of_g[0]), most = at.polar_.trace;
    // Turned inside out so far that R jumps: it does not turn.
    at.turns = abs(size) > 1e-12LF * most * most * most ? transpose(of_g) * (1.0LF / size)
                                                        : dmat3(0.0LF);
  } else if (at.law == 2u) {
    at.normal = c * (1.0LF / j);
    at.pressure = at.lambda * (j > 0.0LF ? log_(j) : 0.0LF);
  } else if (at.law == 3u) {
    at.stress = hooke(green(at.f), at.mu, at.lambda);
  }
  const bool viscous = p.viscous > 0.0LF && (fact & kFiniteLayer) == 0u;
  if (viscous && at.law != 0u) {
    at.viscous = p.viscous * hooke(viscous_way(e, at.law, h), at.mu, at.lambda);
  }
  const bool fibrous = (fact & kFiniteFibrous) != 0u;
  FamilyAt families[2];
  if (fibrous && at.law != 0u) {
    [[unroll]] for (uint i = 0u; i < 2u; ++i) families[i] = family_at(e, i, at.f, h);
  }
  uint t = 0u;
  for (uint b = 0u; b < 9u; ++b) {
    dmat3 d;
    [[unroll]] for (uint k = 0u; k < 3u; ++k) {
      [[unroll]] for (uint i = 0u; i < 3u; ++i) d[k][i] = b == 3u * k + i ? 1.0LF : 0.0LF;
    }
    dmat3 found = change(at, d);
    if (viscous) found += change_of_viscous(at, d);
    if (fibrous && at.law == 0u) found += linear_fibres(e, symmetric(d));
    if (fibrous && at.law != 0u) {
      [[unroll]] for (uint i = 0u; i < 2u; ++i) found += change_of_fibres(families[i], d);
    }
    [[unroll]] for (uint a = 0u; a < 9u; ++a) {
      if (a > b) continue;
      tangents.data[4u * (t / 4u * p.elements + e) + t % 4u] = REAL(volume * found[a / 3u][a % 3u]);
      ++t;
    }
  }
}
