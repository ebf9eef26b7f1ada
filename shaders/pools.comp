#version 460
// SPDX-License-Identifier: Apache-2.0
// Of every patch of pooled volume: its pressure kappa sum a_e V_e tr(eps_e) / sum a_e V_e, and what rounding may
// cost it (core/body/pools).
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Nodal, u)
IN_UVEC4(1, Nodes, nodes)
IN_DVEC4(2, Shape, shape)  // as stress.glsl
IN_UVEC4(3, Facts, facts)
IN_WORDS(4, First, first)  // of each patch, of which the last has none
IN_WORDS(5, Members, members)
layout(std430, set = 0, binding = 6) readonly buffer Bulk { double data[]; } bulk;
OUT(7, Patches, PatchPressure, patches)
layout(push_constant) uniform Push { ElementPush p; };

void main() {
  const uint n = invocation();
  const uint last = first.data[n + 1u];
  const double alpha = double(p.alpha) + double(p.alpha_low);
  double volume = 0, grown = 0, made = 0, shown = 0;
  for (uint k = first.data[n]; k < last; ++k) {
    const uint e = members.data[k];
    const uvec4 at = UVEC4(nodes, e);
    const dvec4 s1 = DVEC4(shape, 3u * e), s2 = DVEC4(shape, 3u * e + 1u),
                s3 = DVEC4(shape, 3u * e + 2u);
    const dvec3 u0 = DVEC4(u, at.x).xyz, d1 = DVEC4(u, at.y).xyz - u0,
                d2 = DVEC4(u, at.z).xyz - u0, d3 = DVEC4(u, at.w).xyz - u0;
    const double own = ((UVEC4(facts, e).x & kDestroyed) != 0u ? alpha : 1.0LF) * s3.w;
    volume += own;
    grown += own * (dot(d1, s1.xyz) + dot(d2, s2.xyz) + dot(d3, s3.xyz));
    const double gradients =
        dot(s1.xyz, s1.xyz) + dot(s2.xyz, s2.xyz) + dot(s3.xyz, s3.xyz);
    made += own * sqrt((dot(d1, d1) + dot(d2, d2) + dot(d3, d3)) * gradients);
    const dvec3 of_first = s1.xyz + s2.xyz + s3.xyz, u1 = u0 + d1, u2 = u0 + d2, u3 = u0 + d3;
    shown += own * sqrt((dot(u0, u0) + dot(u1, u1) + dot(u2, u2) + dot(u3, u3)) *
                        (dot(of_first, of_first) + gradients));
  }
  // Three axes' differences, products and their sum, of up to some ten elements; fp32 where it is shown.
  const double by = volume > 0.0LF ? bulk.data[n] / volume : 0.0LF;
  const double wide = 1.862645149230957e-09LF;  // 2^-53 / 2^-24
  const double rounding =
      1.7320508075688772LF *
      (16.0LF * wide * made + ((p.keep & kShown) != 0u ? shown : 0.0LF));
  patches.data[n] = PatchPressure(by * grown, by * rounding);
}
