#version 460
// SPDX-License-Identifier: Apache-2.0
// Of every patch of pooled volume: J, the mean of its live elements', and with it pressure and energy of volume
// (core/body/pooled_law).
#extension GL_GOOGLE_include_directive : require
#define SUNDER_ELASTIC
#include "finite_laws.glsl"

IN_WORDS(4, First, first)  // of each patch
IN_WORDS(5, Members, members)
OUT(6, Patches, FinitePatch, patches)
layout(push_constant) uniform Push { FinitePush p; };

// J less 1, as each law measures it.
double dilation(uint law, dmat3 h) {
  const dmat3 f = dmat3(1.0LF) + h, c = cofactor(f);
  const double j = dot(f[0], c[0]), trace = h[0][0] + h[1][1] + h[2][2];
  if (law == 0u) return trace;
  if (law == 1u) return polar(f, c, j).trace - 3.0LF;
  if (law == 2u) return j - 1.0LF;
  return trace + 0.5LF * inner(h, h);
}

void main() {
  const uint n = invocation();
  if (n >= p.patches) return;
  uint leading = kHeld, law = 0u;
  double volume = 0, grown = 0, mu = 0, lambda = 0;
  for (uint k = first.data[n]; k < first.data[n + 1u]; ++k) {
    const uint e = members.data[k], fact = facts.data[e], at = kFiniteShape * e;
    if ((fact & kFiniteOut) != 0u) continue;
    law = law_of(fact);
    if (leading == kHeld) leading = e;
    const double own = shape.data[at + 9u];
    mu = shape.data[at + 10u];
    lambda = shape.data[at + 11u];
    volume += own;
    grown += own * dilation(law, gradient(e));
  }
  FinitePatch found = FinitePatch(0.0LF, 0.0LF, leading, 0u);
  if (volume > 0.0LF) {
    const double more = grown / volume, j = 1.0LF + more;
    if (law == 2u && !(j >= kLeastVolume)) {
      found.energy = infinity();
    } else if (law == 2u) {
      const double side = cube_root_(j), face = mu * side * side, log_j = log_(j);
      found.pressure = (lambda * log_j + (face - mu)) / j;
      found.energy = volume * (1.5LF * (face - mu) + log_j * (0.5LF * lambda * log_j - mu));
    } else {
      const double kappa = lambda + mu * (2.0LF / 3.0LF);
      found.pressure = kappa * more;
      found.energy = 0.5LF * volume * found.pressure * more;
    }
  }
  patches.data[n] = found;
}
