#version 460
// SPDX-License-Identifier: Apache-2.0
// Stress a_e D B u of every element, principal stresses, ratio to yield, and the worst of each
// workgroup. The displacement gradient is taken in fp64 from differences: neither a rigid offset
// nor a rigid rotation (of a frame 100 times stiffer, say) costs accuracy in fp32 stress.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Nodal, u)
IN_UVEC4(1, Nodes, nodes)
IN_DVEC4(2, Shape, shape)  // three an element: (grad N_1, lambda), (grad N_2, mu), (grad N_3, V)
IN_WORDS(3, State, state)
OUT(4, Stress, REAL4, stress)  // two an element: (xx, yy, zz, xy), (yz, zx, measure, ratio)
OUT(5, StressPartials, StressPartial, partials)
layout(std430, set = 0, binding = 6) readonly buffer Yield { double data[]; } yield_;
layout(push_constant) uniform Push { ElementPush p; };

#ifdef SUNDER_FP64
const int kSweeps = 5;
#else
const int kSweeps = 4;
#endif

// One Jacobi rotation that zeroes m[i][j]; k is the third index. Principal stresses from rotations
// keep full accuracy where two of them are near each other (uniaxial tension), where invariants
// lose half the digits. Divisions and square roots are correctly rounded, sines are not.
void rotate(inout REAL a_ii, inout REAL a_jj, inout REAL a_ij, inout REAL a_ik, inout REAL a_jk) {
  const bool small = a_ij == REAL(0);
  const REAL theta = (a_jj - a_ii) / (small ? REAL(1) : REAL(2) * a_ij);
  const REAL size = abs(theta);
  // For a huge theta its square may overflow to infinity; t is then 0, as it should be.
  const REAL t_size = REAL(1) / (size + sqrt(size * size + REAL(1)));
  const REAL t = small ? REAL(0) : (theta < REAL(0) ? -t_size : t_size);
  const REAL c = REAL(1) / sqrt(t * t + REAL(1));
  const REAL s = t * c;
  a_ii -= t * a_ij;
  a_jj += t * a_ij;
  a_ij = REAL(0);
  const REAL ik = c * a_ik - s * a_jk;
  a_jk = s * a_ik + c * a_jk;
  a_ik = ik;
}

// s1 - s3.
REAL principal_range(REAL xx, REAL yy, REAL zz, REAL xy, REAL yz, REAL zx) {
  [[unroll]] for (int sweep = 0; sweep < kSweeps; ++sweep) {
    rotate(xx, yy, xy, zx, yz);
    rotate(xx, zz, zx, xy, yz);
    rotate(yy, zz, yz, xy, zx);
  }
  return max(xx, max(yy, zz)) - min(xx, min(yy, zz));
}

shared StressPartial worst[kGroup];

void keep_worse(uint to, uint from) {
  const StressPartial b = worst[from];
  StressPartial a = worst[to];
  if (b.any_ratio > a.any_ratio ||
      (b.any_ratio == a.any_ratio && b.any_element < a.any_element)) {
    a.any_ratio = b.any_ratio;
    a.any_element = b.any_element;
  }
  if (b.candidate_ratio > a.candidate_ratio ||
      (b.candidate_ratio == a.candidate_ratio && b.candidate_element < a.candidate_element)) {
    a.candidate_ratio = b.candidate_ratio;
    a.candidate_element = b.candidate_element;
  }
  a.stress_squared = max(a.stress_squared, b.stress_squared);
  worst[to] = a;
}

void main() {
  const uint e = gl_GlobalInvocationID.x;
  const uvec4 n = UVEC4(nodes, e);
  const dvec4 s1 = DVEC4(shape, 3u * e), s2 = DVEC4(shape, 3u * e + 1u),
              s3 = DVEC4(shape, 3u * e + 2u);
  const dvec3 u0 = DVEC4(u, n.x).xyz;
  const dvec3 d1 = DVEC4(u, n.y).xyz - u0, d2 = DVEC4(u, n.z).xyz - u0,
              d3 = DVEC4(u, n.w).xyz - u0;
  const REAL3 hx = REAL3(d1 * s1.x + d2 * s2.x + d3 * s3.x);  // derivatives along x
  const REAL3 hy = REAL3(d1 * s1.y + d2 * s2.y + d3 * s3.y);
  const REAL3 hz = REAL3(d1 * s1.z + d2 * s2.z + d3 * s3.z);
  const REAL pressure = REAL(s1.w) * (hx.x + hy.y + hz.z);
  const REAL mu = REAL(s2.w);
  const REAL xx = pressure + REAL(2) * mu * hx.x, yy = pressure + REAL(2) * mu * hy.y,
             zz = pressure + REAL(2) * mu * hz.z;
  const REAL xy = mu * (hy.x + hx.y), yz = mu * (hz.y + hy.z), zx = mu * (hx.z + hz.x);
  const uint bits = state.data[e];
  const bool live = (bits & (kDestroyed | kAbsent)) == 0u;
  const REAL range = principal_range(xx, yy, zz, xy, yz, zx);
  const REAL measure = p.tresca != 0u ? range : range / REAL(2);
  const bool counts = live && (bits & kBreakable) != 0u;
  const REAL ratio = counts ? measure / REAL(yield_.data[e]) : REAL(0);
  if (p.store != 0u) {
    const REAL scale = (bits & kDestroyed) != 0u ? REAL(p.alpha) : REAL(1);
    stress.data[2u * e] = scale * REAL4(xx, yy, zz, xy);
    stress.data[2u * e + 1u] = REAL4(scale * yz, scale * zx, scale * measure, ratio);
  }
  const double dxx = double(xx), dyy = double(yy), dzz = double(zz), dxy = double(xy),
               dyz = double(yz), dzx = double(zx);
  const uint lane = gl_LocalInvocationID.x;
  worst[lane].any_ratio = double(ratio);
  worst[lane].any_element = ratio > REAL(0) ? e : kHeld;
  const bool candidate = ratio > REAL(0) && (bits & kExcluded) == 0u;
  worst[lane].candidate_ratio = candidate ? double(ratio) : 0.0LF;
  worst[lane].candidate_element = candidate ? e : kHeld;
  worst[lane].stress_squared =
      live ? dxx * dxx + dyy * dyy + dzz * dzz + 2 * (dxy * dxy + dyz * dyz + dzx * dzx) : 0.0LF;
  for (uint half_ = kGroup / 2u; half_ > 0u; half_ /= 2u) {
    barrier();
    if (lane < half_) keep_worse(lane, lane + half_);
  }
  if (lane == 0u) partials.data[gl_WorkGroupID.x] = worst[0];
}
