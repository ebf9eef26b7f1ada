#version 460
// SPDX-License-Identifier: Apache-2.0
// Forces of an element on its corners, a_e V sigma grad N_a, in fp64 from displacement differences:
// the first half of f - K u.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Nodal, u)
IN_UVEC4(1, Nodes, nodes)
IN_DVEC4(2, Shape, shape)  // three an element: (grad N_1, lambda), (grad N_2, mu), (grad N_3, V)
IN_WORDS(3, State, state)
OUT(4, Force, dvec4, force)
layout(push_constant) uniform Push { ElementPush p; };

void main() {
  const uint e = gl_GlobalInvocationID.x;
  const uvec4 n = UVEC4(nodes, e);
  const dvec4 s1 = DVEC4(shape, 3u * e), s2 = DVEC4(shape, 3u * e + 1u),
              s3 = DVEC4(shape, 3u * e + 2u);
  const dvec3 u0 = DVEC4(u, n.x).xyz;
  const dvec3 d1 = DVEC4(u, n.y).xyz - u0, d2 = DVEC4(u, n.z).xyz - u0,
              d3 = DVEC4(u, n.w).xyz - u0;
  // H = du/dx; column j: derivative along j.
  const dmat3 h = dmat3(d1 * s1.x + d2 * s2.x + d3 * s3.x, d1 * s1.y + d2 * s2.y + d3 * s3.y,
                        d1 * s1.z + d2 * s2.z + d3 * s3.z);
  const double scale = s3.w * ((state.data[e] & kDestroyed) != 0u ? p.alpha : 1.0LF);
  const double pressure = scale * s1.w * (h[0][0] + h[1][1] + h[2][2]);
  const double mu = scale * s2.w;
  const double xy = mu * (h[1][0] + h[0][1]), yz = mu * (h[2][1] + h[1][2]),
               zx = mu * (h[0][2] + h[2][0]);
  const dmat3 sigma = dmat3(pressure + 2 * mu * h[0][0], xy, zx, xy, pressure + 2 * mu * h[1][1],
                            yz, zx, yz, pressure + 2 * mu * h[2][2]);
  const dvec3 f1 = sigma * s1.xyz, f2 = sigma * s2.xyz, f3 = sigma * s3.xyz;
  force.data[4u * e] = dvec4(-(f1 + f2 + f3), 0);
  force.data[4u * e + 1u] = dvec4(f1, 0);
  force.data[4u * e + 2u] = dvec4(f2, 0);
  force.data[4u * e + 3u] = dvec4(f3, 0);
}
