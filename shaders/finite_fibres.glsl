// SPDX-License-Identifier: Apache-2.0
// Fibres of an element, by the formulas of core/material/fibres.hpp. FIBRES_AT: the binding.
IN_DOUBLES(FIBRES_AT, Fibres, fibres)

// e^x for 0 <= x <= 100: x = k ln 2 + r, |r| <= ln 2 / 2, and Taylor's series of e^r.
double exp_(double x) {
  const int k = int(x * 1.44269504088896340736LF + 0.5LF);
  const double r = (x - double(k) * 0.693147180369123816490LF) -
                   double(k) * 1.90821492927058770002e-10LF;
  double series = 1.0LF;
  [[unroll]] for (int n = 16; n >= 1; --n) series = 1.0LF + series * r / double(n);
  return series * packDouble2x32(uvec2(0u, uint(k + 1023) << 20u));
}

// (e^x - 1)/x.
double growth_(double x) {
  if (x > 0.5LF) return (exp_(x) - 1.0LF) / x;
  double series = 1.0LF;
  [[unroll]] for (int n = 17; n >= 2; --n) series = 1.0LF + series * x / double(n);
  return series;
}

struct Family {
  dvec3 a;
  double k1, k2, dispersion;
};

Family family_of(uint e, uint i) {
  const uint at = kFiniteFibres * e + 6u * i;
  return Family(dvec3(fibres.data[at], fibres.data[at + 1u], fibres.data[at + 2u]),
                fibres.data[at + 3u], fibres.data[at + 4u], fibres.data[at + 5u]);
}

dmat3 structure(Family of) {
  return of.dispersion * dmat3(1.0LF) +
         (1.0LF - 3.0LF * of.dispersion) * outerProduct(of.a, of.a);
}

// E of h = F - I; of slack fibres 0.
double stretched(Family of, dmat3 h) {
  const dmat3 twice_strain = h + transpose(h) + transpose(h) * h;
  const double e = of.dispersion * (twice_strain[0][0] + twice_strain[1][1] + twice_strain[2][2]) +
                   (1.0LF - 3.0LF * of.dispersion) * dot(of.a, twice_strain * of.a);
  return of.k1 > 0.0LF && e > 0.0LF ? e : 0.0LF;
}

// Of the linear theory, at the strain s.
dmat3 linear_fibres(uint e, dmat3 s) {
  const dvec3 a = family_of(e, 0u).a;
  const uint at = kFiniteFibres * e + 12u;
  const double lambda = fibres.data[at], alpha = fibres.data[at + 1u], beta = fibres.data[at + 2u],
               mu = fibres.data[at + 3u];
  const dvec3 sa = s * a;
  const double along = dot(a, sa), trace = s[0][0] + s[1][1] + s[2][2];
  return (lambda * trace + alpha * along) * dmat3(1.0LF) +
         (alpha * trace + beta * along) * outerProduct(a, a) +
         2.0LF * mu * (outerProduct(a, sa) + outerProduct(sa, a));
}
