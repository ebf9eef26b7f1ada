// SPDX-License-Identifier: Apache-2.0
// Stress a_e D B u of every element, principal stresses, ratio to yield, and the worst of each
// workgroup. Strain is taken in fp64 from differences: neither a rigid offset nor a rigid rotation
// (of a frame 10,000 times stiffer, say, or of a part that hangs on by one element) costs accuracy
// in fp32 stress. SUNDER_POOLED: where its volume is its patch's, D knows no change of volume, and the
// patch's pressure is added.
#include "common.glsl"
#include "principal.glsl"
#include "reduce.glsl"
#include "two_float.glsl"

IN_WIDE4(0, Nodal, u)
IN_UVEC4(1, Nodes, nodes)
IN_WIDE4(2, Shape, shape)  // three an element: (grad N_1, lambda), (grad N_2, mu), (grad N_3, V)
IN_UVEC4(3, Facts, facts)
#if defined(SUNDER_LVP) && !defined(SUNDER_FP64)
OUT(4, Stress, u64vec4, stress)  // eight floats at once: lavapipe stores lane by lane
#else
OUT(4, Stress, REAL4, stress)  // two an element: (xx, yy, zz, xy), (yz, zx, measure, ratio)
#endif
OUT(5, StressPartials, StressPartial, partials)
layout(std430, set = 0, binding = 6) buffer Over {
  uint count;
  uint elements[];
} over;
#ifdef SUNDER_POOLED
layout(std430, set = 0, binding = 7) readonly buffer Patches { PatchPressure data[]; } patches;
#endif
layout(push_constant) uniform Push { ElementPush p; };

void store(uint e, REAL4 a, REAL4 b) {
#if defined(SUNDER_LVP) && !defined(SUNDER_FP64)
  stress.data[e] =
      u64vec4(packUint2x32(floatBitsToUint(a.xy)), packUint2x32(floatBitsToUint(a.zw)),
              packUint2x32(floatBitsToUint(b.xy)), packUint2x32(floatBitsToUint(b.zw)));
#else
  stress.data[2u * e] = a;
  stress.data[2u * e + 1u] = b;
#endif
}

#ifndef SUNDER_LVP
shared Worst shared_any[kGroup], shared_candidate[kGroup];
shared REAL shared_norm[kGroup];
shared uvec3 shared_deformation[kGroup];
shared float shared_handed_out[kGroup];
#endif

// One partial result of the invocations that share a part.
void leave(Worst any, Worst candidate, REAL norm, uvec3 deformation, float handed_out) {
  any = subgroup_worst(any);
  candidate = subgroup_worst(candidate);
  norm = subgroupMax(norm);
  deformation = uvec3(subgroupMax(deformation.x), subgroupMax(deformation.y),
                      subgroupAdd(deformation.z));
  handed_out = subgroupMax(handed_out);
#ifndef SUNDER_LVP
  if (subgroupElect()) {
    shared_any[gl_SubgroupID] = any;
    shared_candidate[gl_SubgroupID] = candidate;
    shared_norm[gl_SubgroupID] = norm;
    shared_deformation[gl_SubgroupID] = deformation;
    shared_handed_out[gl_SubgroupID] = handed_out;
  }
  barrier();
  deformation = uvec3(0u);
  for (uint s = 0u; s < gl_NumSubgroups; ++s) {
    keep_worse(any, shared_any[s]);
    keep_worse(candidate, shared_candidate[s]);
    norm = max(norm, shared_norm[s]);
    deformation = uvec3(max(deformation.xy, shared_deformation[s].xy),
                        deformation.z + shared_deformation[s].z);
    handed_out = max(handed_out, shared_handed_out[s]);
  }
#endif
  if (leads_part()) {
    const WIDE norm_ = WIDE(norm);
    partials.data[part()] = StressPartial(WIDE(any.ratio), WIDE(candidate.ratio), norm_ * norm_,
                                          any.element, candidate.element, deformation.x, deformation.y,
                                          deformation.z, handed_out);
  }
}

// Strain, curl, and the Lame constants. Of the displacement's gradient, Frobenius: `made`: what it may
// be off by as it is made of differences, by five of their roundings; `shown`: what rounding the
// corners' displacement to fp32 may change, by 2^-24.
struct Deformation {
  REAL3 strain, twice_shear;  // (xx, yy, zz), twice (xy, yz, zx)
  REAL lambda, mu;
  vec3 curl;
  float made, shown;
};

// Largest strain, rotation and inversion of a live element as StressPartial has them. The rotation's
// axis is taken to be the curl's: true to second order in strain, exact in a plane. With it
// tan(theta) = |curl|/2 / (1 + (tr E - n E n)/2) holds (core/body/deformation.cpp).
uvec3 deformation_of(Deformation d, Principal e) {
  const vec3 normal = vec3(d.strain), twice = vec3(d.twice_shear), w = d.curl;
  const float largest = float(e.largest);
  const bool shorter = -e.least > largest;
  const uint strain =
      (floatBitsToUint(shorter ? -e.least : max(largest, 0.0f)) & ~1u) | (shorter ? 1u : 0u);
  const float squared = dot(w, w);
  const float along = squared > 0.0f
      ? (dot(w * w, normal) + w.x * w.y * twice.x + w.y * w.z * twice.y + w.z * w.x * twice.z) / squared
      : 0.0f;
  const float sine = 0.5f * sqrt(squared);
  const float cosine = 1.0f + 0.5f * (normal.x + normal.y + normal.z - along);
  const float sum = cosine + sqrt(0.25f * squared + cosine * cosine);
  const float half_tangent = sine > 0.0f ? sine / max(sum, 1e-30f) : 0.0f;
  const vec3 f = 1.0f + normal, up = 0.5f * (twice - w.zxy), low = 0.5f * (twice + w.zxy);
  // F = (f.x, up.x, low.z; low.x, f.y, up.y; up.z, low.y, f.z)
  const float det = f.x * (f.y * f.z - up.y * low.y) - up.x * (low.x * f.z - up.y * up.z) +
                    low.z * (low.x * low.y - f.y * up.z);
  return uvec3(strain, floatBitsToUint(half_tangent), det > 0.0f ? 0u : 1u);
}

// sum |u_a - u_0| |grad N_a| <= |D| |G|, each difference rounded once, its product once, their sum
// and the two halves of a shear three times.
float made_change(vec3 d1, vec3 d2, vec3 d3, vec3 g1, vec3 g2, vec3 g3) {
  return sqrt((dot(d1, d1) + dot(d2, d2) + dot(d3, d3)) *
              (dot(g1, g1) + dot(g2, g2) + dot(g3, g3)));
}

// sum |u_a| |grad N_a| <= |U| |G|, from u of corner 0, the differences to it and the gradients of
// the other shape functions; that of corner 0 is minus their sum.
float shown_change(vec3 u0, vec3 d1, vec3 d2, vec3 d3, vec3 g1, vec3 g2, vec3 g3) {
  const vec3 u1 = u0 + d1, u2 = u0 + d2, u3 = u0 + d3, g0 = g1 + g2 + g3;
  return sqrt((dot(u0, u0) + dot(u1, u1) + dot(u2, u2) + dot(u3, u3)) *
              (dot(g0, g0) + dot(g1, g1) + dot(g2, g2) + dot(g3, g3)));
}

// Bound of what an element's stress, as it is read, may be off by, Frobenius, by 2^-24 [MPa]. Strain is
// rounded once; each further operation of `main` once. With e the diagonal of strain and p the
// pressure: lambda (|e_x| + |e_y| + |e_z| + |e_x + e_y|) from the rounding of strain and of its
// first sum, 3 |p| from the second sum, lambda and their product, all three times in the norm; 3 of
// 2 mu |strain| from strain, mu and their product; 1 of |stress| from the last sum. `of_patch`: of the
// pressure that is a patch's.
float rounding_of_stress(Deformation d, REAL pressure, float of_patch, REAL norm) {
  const vec3 e = vec3(abs(d.strain));
  const float lambda = abs(float(d.lambda)), mu = float(d.mu);
  const float of_pressure =
      lambda * (e.x + e.y + e.z + abs(float(d.strain.x + d.strain.y))) + 3.0 * abs(float(pressure));
  const vec3 g = vec3(d.twice_shear);
  const float of_strain = 2.0 * mu * sqrt(dot(e, e) + 0.5 * dot(g, g));
  float sum = 1.7320509 * of_pressure + 3.0 * of_strain + float(norm);
  const float stiffest = max(3.0 * float(d.lambda) + 2.0 * mu, 2.0 * mu);
  const float wide = 1.862645149e-9;  // 2^-53 / 2^-24
#ifdef SUNDER_FP64
  sum *= wide;
#endif
#ifdef SUNDER_SINGLE
  sum += 5.0 * 512.0 * wide * stiffest * d.made;  // two floats hold 44 bits of a product
#else
  sum += 5.0 * wide * stiffest * d.made;
#endif
  // Shown in fp32: the stress that a host takes from the displacement, or that it is handed.
  if ((p.keep & kShown) != 0u) {
    sum += stiffest * d.shown + float(norm);
  }
  return sum + 1.7320509 * of_patch;
}

#ifdef SUNDER_SINGLE
#define LOAD_TWO3(name, i) two3(VEC4(name, 2u * (i)), VEC4(name, 2u * (i) + 1u))
Two3 derivative(Two3 d1, vec2 s1, Two3 d2, vec2 s2, Two3 d3, vec2 s3) {
  return plus(plus(times(d1, s1), times(d2, s2)), times(d3, s3));
}
Deformation deformation(uint e, uvec4 n) {
  const Two3 u0 = LOAD_TWO3(u, n.x);
  const Two3 d1 = minus(LOAD_TWO3(u, n.y), u0), d2 = minus(LOAD_TWO3(u, n.z), u0),
             d3 = minus(LOAD_TWO3(u, n.w), u0);
  const vec4 a1 = VEC4(shape, 6u * e), b1 = VEC4(shape, 6u * e + 1u),
             a2 = VEC4(shape, 6u * e + 2u), b2 = VEC4(shape, 6u * e + 3u),
             a3 = VEC4(shape, 6u * e + 4u), b3 = VEC4(shape, 6u * e + 5u);
  const Two3 hx = derivative(d1, a1.xy, d2, a2.xy, d3, a3.xy),
             hy = derivative(d1, a1.zw, d2, a2.zw, d3, a3.zw),
             hz = derivative(d1, b1.xy, d2, b2.xy, d3, b3.xy);
  const Two3 twice_shear = plus(Two3(vec3(hy.high.x, hz.high.y, hx.high.z),
                                     vec3(hy.low.x, hz.low.y, hx.low.z)),
                                Two3(vec3(hx.high.y, hy.high.z, hz.high.x),
                                     vec3(hx.low.y, hy.low.z, hz.low.x)));
  return Deformation(vec3(hx.high.x + hx.low.x, hy.high.y + hy.low.y, hz.high.z + hz.low.z),
                     twice_shear.high + twice_shear.low, b1.z, b2.z,
                     vec3(hy.high.z - hz.high.y, hz.high.x - hx.high.z, hx.high.y - hy.high.x),
                     made_change(d1.high, d2.high, d3.high, vec3(a1.xz, b1.x), vec3(a2.xz, b2.x),
                                 vec3(a3.xz, b3.x)),
                     shown_change(u0.high, d1.high, d2.high, d3.high, vec3(a1.xz, b1.x),
                                  vec3(a2.xz, b2.x), vec3(a3.xz, b3.x)));
}
#else
Deformation deformation(uint e, uvec4 n) {
  const dvec4 s1 = DVEC4(shape, 3u * e), s2 = DVEC4(shape, 3u * e + 1u),
              s3 = DVEC4(shape, 3u * e + 2u);
  const dvec3 u0 = DVEC4(u, n.x).xyz;
  const dvec3 d1 = DVEC4(u, n.y).xyz - u0, d2 = DVEC4(u, n.z).xyz - u0, d3 = DVEC4(u, n.w).xyz - u0;
  const dvec3 hx = d1 * s1.x + d2 * s2.x + d3 * s3.x, hy = d1 * s1.y + d2 * s2.y + d3 * s3.y,
              hz = d1 * s1.z + d2 * s2.z + d3 * s3.z;
  return Deformation(REAL3(hx.x, hy.y, hz.z),
                     REAL3(hy.x + hx.y, hz.y + hy.z, hx.z + hz.x), REAL(s1.w), REAL(s2.w),
                     vec3(hy.z - hz.y, hz.x - hx.z, hx.y - hy.x),
                     made_change(vec3(d1), vec3(d2), vec3(d3), vec3(s1.xyz), vec3(s2.xyz),
                                 vec3(s3.xyz)),
                     shown_change(vec3(u0), vec3(d1), vec3(d2), vec3(d3), vec3(s1.xyz),
                                  vec3(s2.xyz), vec3(s3.xyz)));
}
#endif

void main() {
  const uint e = invocation();
  const Deformation d = deformation(e, UVEC4(nodes, e));
  const REAL3 strain = d.strain, twice_shear = d.twice_shear;
  const uvec4 fact = UVEC4(facts, e);
  const REAL mu = d.mu, own_pressure = d.lambda * (strain.x + strain.y + strain.z);
#ifdef SUNDER_POOLED
  const bool pooled = fact.y > 0u;
  const uint patch_ = max(fact.y, 1u) - 1u;
  const REAL patch_pressure = pooled ? REAL(patches.data[patch_].pressure) : REAL(0);
  const REAL pressure = own_pressure + patch_pressure;
  const REAL pressures = abs(own_pressure) + abs(patch_pressure);
  const float patch_rounding = pooled ? float(patches.data[patch_].rounding) : 0.0;
#else
  const REAL pressure = own_pressure, pressures = pressure;
  const float patch_rounding = 0.0;
#endif
  const REAL3 normal = pressure + REAL(2) * mu * strain;
  const REAL3 shear = mu * twice_shear;  // xy, yz, zx
  const uint bits = fact.x;
  const bool live = (bits & (kDestroyed | kAbsent)) == 0u;
  // Of the strain: the pressure of a nearly incompressible body would hide it in rounding.
  const Principal of_strain = principal(strain, twice_shear / REAL(2));
  const REAL range = REAL(2) * mu * of_strain.range;
  const REAL measure = p.measure == 2u ? pressure + REAL(2) * mu * of_strain.largest
                       : p.measure == 1u ? range
                                         : range / REAL(2);
  const bool counts = live && (bits & kBreakable) != 0u;
#ifdef SUNDER_SINGLE
  const float yield_ = uintBitsToFloat(fact.z);
#else
  const REAL yield_ = REAL(packDouble2x32(fact.zw));
#endif
  const REAL ratio = counts ? measure / yield_ : REAL(0);
  if ((p.keep & kKeepStress) != 0u) {
    const REAL scale = (bits & kDestroyed) != 0u ? REAL(p.alpha) + REAL(p.alpha_low) : REAL(1);
    store(e, scale * REAL4(normal, shear.x),
          REAL4(scale * shear.yz, scale * measure, ratio));
  }
  if ((p.keep & kListOver) != 0u && ratio >= REAL(1)) {
    over.elements[atomicAdd(over.count, 1u)] = e;  // the host sorts
  }
  const REAL norm = sqrt(dot(normal, normal) + REAL(2) * dot(shear, shear));
  const REAL infinity = REAL(uintBitsToFloat(0x7f800000u));
  const bool some = ratio > REAL(0), candidate = some && (bits & kExcluded) == 0u;
  leave(Worst(some ? ratio : REAL(0), some ? e : kHeld),
        Worst(candidate ? ratio : REAL(0), candidate ? e : kHeld),
        !live ? REAL(0) : (norm < infinity ? norm : infinity),  // NaN included
        live && (bits & kCutOff) == 0u ? deformation_of(d, of_strain) : uvec3(0u),
        live ? rounding_of_stress(d, pressures, patch_rounding, norm) : 0.0);
}
