// SPDX-License-Identifier: Apache-2.0
// Of every element: internal forces V P grad N and viscous ones on its corners, its stress, energy, and how
// far its stress is from that of another state. SUNDER_POOLED: where its volume is its patch's, P is that of
// its shape and the patch's pressure.
#include "finite_laws.glsl"
#define FIBRES_AT 10
#include "finite_fibres.glsl"

IN_DOUBLES(5, Before, before)  // stress of the other state, six an element
OUT(6, Corners, double, corners)
OUT(7, ViscousCorners, double, viscous_corners)
OUT(8, Stress, double, stress)
OUT(9, Partials, FiniteElementPartial, partials)
#ifdef SUNDER_POOLED
layout(std430, set = 0, binding = 11) readonly buffer Patches { FinitePatch data[]; } patches;
#endif
layout(push_constant) uniform Push { FinitePush p; };

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

struct Response {
  double energy;
  dmat3 p;
};

Response respond(uint law, double mu, double lambda, dmat3 f, dmat3 c, double volume, Polar of) {
  Response found;
  if (law == 0u) {
    const dmat3 e = symmetric(f) - dmat3(1.0LF);
    found.p = hooke(e, mu, lambda);
    found.energy = 0.5LF * inner(found.p, e);
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
    const dmat3 e = green(f), s = hooke(e, mu, lambda);
    found.energy = 0.5LF * inner(s, e);
    found.p = f * s;
  }
  return found;
}

#ifdef SUNDER_POOLED
// W_s, and its stress with that of the patch's pressure. `lambda`: without the resistance to a change of volume.
Response respond_in_patch(uint law, double mu, double lambda, dmat3 f, dmat3 c, double volume,
                          Polar of, double pressure) {
  Response found;
  if (law == 2u) {
    const double side = volume >= kLeastVolume ? cube_root_(volume) : 1.0LF;
    found.energy = volume >= kLeastVolume ? 0.5LF * mu * (inner(f, f) - 3.0LF * (side * side))
                                          : infinity();
    found.p = mu * f + (pressure - mu / side) * c;
    return found;
  }
  found = respond(law, mu, lambda, f, c, volume, of);
  if (law == 0u) found.p += pressure * dmat3(1.0LF);
  else if (law == 1u) found.p += pressure * of.r;
  else found.p += pressure * f;
  return found;
}
#endif

// What fibres add. Past this exponent no tissue bears the stress: no state of the law.
void add_fibres(uint e, uint law, dmat3 h, dmat3 f, inout Response to) {
  if (law == 0u) {
    const dmat3 strain = symmetric(h), p_ = linear_fibres(e, strain);
    to.p += p_;
    to.energy += 0.5LF * inner(p_, strain);
    return;
  }
  for (uint i = 0u; i < 2u; ++i) {
    const Family of = family_of(e, i);
    const double along = stretched(of, h), exponent = of.k2 * along * along;
    if (!(exponent <= 100.0LF)) {
      to.energy = infinity();
      return;
    }
    to.energy += 0.5LF * of.k1 * along * along * growth_(exponent);
    if (along > 0.0LF) to.p += (2.0LF * of.k1 * exp_(exponent) * along) * (f * structure(of));
  }
}

// Potential of the viscous stress, whose forces are left at the corners.
double resist(uint e, uint law, dmat3 h, double volume, double mu, double lambda) {
  const dmat3 way = viscous_way(e, law, h);
  dmat3 s = hooke(way, mu, lambda) * (p.viscous * volume);
  const double potential = 0.5LF * inner(s, way);
  if (law != 0u) s += h * s;
  put(e, s, true);
  return potential;
}

void main() {
  const uint e = invocation();
  double energy = 0, viscous = 0, stress_squared = 0, change_squared = 0;
  const uint fact = e < p.elements ? facts.data[e] : kFiniteOut;
  if (e < p.elements && (fact & kFiniteOut) != 0u) {
    put(e, dmat3(0.0LF), false);
    if (p.viscous > 0.0LF) put(e, dmat3(0.0LF), true);
    [[unroll]] for (uint i = 0u; i < 6u; ++i) stress.data[6u * e + i] = 0.0LF;
  } else if (e < p.elements) {
    const uint law = law_of(fact), at = kFiniteShape * e;
    const double volume = shape.data[at + 9u], mu = shape.data[at + 10u];
#ifdef SUNDER_POOLED
    const bool pooled = (fact & kFinitePooled) != 0u;
    const FinitePatch patch_ = patches.data[pooled ? fact / kFinitePatch : 0u];
    const double lambda = pooled ? mu * (-2.0LF / 3.0LF) : shape.data[at + 11u];
#else
    const double lambda = shape.data[at + 11u];
#endif
    const dmat3 h = gradient(e);
    const dmat3 f = dmat3(1.0LF) + h, c = cofactor(f);
    const double j = dot(f[0], c[0]);
    const bool layer = (fact & kFiniteLayer) != 0u, biot = layer || p.biot != 0u;
    Polar of;
    if (law == 1u || biot) of = polar(f, c, j);
#ifdef SUNDER_POOLED
    Response found;
    if (pooled) found = respond_in_patch(law, mu, lambda, f, c, j, of, patch_.pressure);
    else found = respond(law, mu, lambda, f, c, j, of);
#else
    Response found = respond(law, mu, lambda, f, c, j, of);
#endif
    if ((fact & kFiniteFibrous) != 0u) add_fibres(e, law, h, f, found);
    const bool acts = !isinf(found.energy) && !isnan(found.energy);
    energy = volume * found.energy;
#ifdef SUNDER_POOLED
    if (pooled && patch_.first == e) energy += patch_.energy;
#endif
    put(e, acts ? volume * found.p : dmat3(0.0LF), false);
    // The linear law (0) knows one measure alone.
    dmat3 s = found.p;
    if (law != 0u) {
      s = biot ? symmetric(transpose(of.r) * found.p)
               : symmetric(found.p * transpose(f)) * (1.0LF / j);
    }
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
    if (p.viscous > 0.0LF && layer) put(e, dmat3(0.0LF), true);
    else if (p.viscous > 0.0LF) viscous = resist(e, law, h, volume, mu, lambda);
  }
  leave(energy, viscous, stress_squared, change_squared);
}
