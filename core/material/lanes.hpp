// SPDX-License-Identifier: Apache-2.0
// The laws of core/material once more, without branches and without calls, so that a loop over
// elements becomes one over the lanes of a vector register. The laws themselves (law.hpp) say what
// is right; these agree with them to rounding.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "machine/compiler.hpp"

#define SUNDER_IN_LANES SUNDER_FORCE_INLINE

namespace sunder::lanes {

struct Matrix {
  double at[3][3];  // row, column
};

SUNDER_IN_LANES double inner(const Matrix& a, const Matrix& b) {
  return (a.at[0][0] * b.at[0][0] + a.at[0][1] * b.at[0][1] + a.at[0][2] * b.at[0][2]) +
         (a.at[1][0] * b.at[1][0] + a.at[1][1] * b.at[1][1] + a.at[1][2] * b.at[1][2]) +
         (a.at[2][0] * b.at[2][0] + a.at[2][1] * b.at[2][1] + a.at[2][2] * b.at[2][2]);
}

/// J F^-T.
SUNDER_IN_LANES Matrix cofactor(const Matrix& f) {
  const auto& a = f.at;
  return {{{a[1][1] * a[2][2] - a[1][2] * a[2][1], a[1][2] * a[2][0] - a[1][0] * a[2][2],
            a[1][0] * a[2][1] - a[1][1] * a[2][0]},
           {a[2][1] * a[0][2] - a[2][2] * a[0][1], a[2][2] * a[0][0] - a[2][0] * a[0][2],
            a[2][0] * a[0][1] - a[2][1] * a[0][0]},
           {a[0][1] * a[1][2] - a[0][2] * a[1][1], a[0][2] * a[1][0] - a[0][0] * a[1][2],
            a[0][0] * a[1][1] - a[0][1] * a[1][0]}}};
}

SUNDER_IN_LANES double determinant(const Matrix& f, const Matrix& of_cofactors) {
  return f.at[0][0] * of_cofactors.at[0][0] + f.at[0][1] * of_cofactors.at[0][1] +
         f.at[0][2] * of_cofactors.at[0][2];
}

/// A symmetric one.
struct Symmetric {
  double xx, yy, zz, xy, yz, zx;
};

/// sym(A^T B).
SUNDER_IN_LANES Symmetric symmetric_product(const Matrix& a, const Matrix& b) {
  const auto dot = [&](int i, int j) SUNDER_FORCE_INLINE_LAMBDA {
    return a.at[0][i] * b.at[0][j] + a.at[1][i] * b.at[1][j] + a.at[2][i] * b.at[2][j];
  };
  return {dot(0, 0),
          dot(1, 1),
          dot(2, 2),
          0.5 * (dot(0, 1) + dot(1, 0)),
          0.5 * (dot(1, 2) + dot(2, 1)),
          0.5 * (dot(2, 0) + dot(0, 2))};
}

SUNDER_IN_LANES Matrix transposed(const Matrix& a) {
  return {{{a.at[0][0], a.at[1][0], a.at[2][0]},
           {a.at[0][1], a.at[1][1], a.at[2][1]},
           {a.at[0][2], a.at[1][2], a.at[2][2]}}};
}

/// sym(A B^T).
SUNDER_IN_LANES Symmetric symmetric_product_by_rows(const Matrix& a, const Matrix& b) {
  return symmetric_product(transposed(a), transposed(b));
}

/// F^T F.
SUNDER_IN_LANES Symmetric cauchy_green(const Matrix& f) {
  const auto dot = [&](int i, int j) SUNDER_FORCE_INLINE_LAMBDA {
    return f.at[0][i] * f.at[0][j] + f.at[1][i] * f.at[1][j] + f.at[2][i] * f.at[2][j];
  };
  return {dot(0, 0), dot(1, 1), dot(2, 2), dot(0, 1), dot(1, 2), dot(2, 0)};
}

/// F S.
SUNDER_IN_LANES Matrix times(const Matrix& f, const Symmetric& s) {
  Matrix m;
  for (int i = 0; i < 3; ++i) {
    const double x = f.at[i][0], y = f.at[i][1], z = f.at[i][2];
    m.at[i][0] = x * s.xx + y * s.xy + z * s.zx;
    m.at[i][1] = x * s.xy + y * s.yy + z * s.yz;
    m.at[i][2] = x * s.zx + y * s.yz + z * s.zz;
  }
  return m;
}

/// Of a tensor whose off-diagonal entries count twice.
SUNDER_IN_LANES double squared_norm(const Symmetric& s) {
  return (s.xx * s.xx + s.yy * s.yy + s.zz * s.zz) + 2 * (s.xy * s.xy + s.yz * s.yz + s.zx * s.zx);
}

SUNDER_IN_LANES double determinant(const Symmetric& s) {
  return s.xx * (s.yy * s.zz - s.yz * s.yz) - s.xy * (s.xy * s.zz - s.yz * s.zx) +
         s.zx * (s.xy * s.yz - s.yy * s.zx);
}

/// Natural logarithm of x > 0, to two units in the last place; of what is not finite no number.
/// x = 2^k m with m about 1, and ln m = 2 artanh z with z = (m - 1)/(m + 1), |z| < 0.1716, by its
/// series: what is left out is below 1e-17 of it. No library's, whose bits depend on the machine.
SUNDER_IN_LANES double log(double x) {
  constexpr double kTwo54 = 0x1p54, kTwo52 = 0x1p52;
  constexpr std::uint64_t kRootHalf = 0x3fe6a09e667f3bcd, kOne = 0x3ff0000000000000,
                          kMantissa = 0x000fffffffffffff;
  constexpr double kLn2High = 0x1.62e42fee00000p-1, kLn2Low = 0x1.a39ef35793c76p-33;
  const bool small = x < std::numeric_limits<double>::min();
  const double scaled = x * (small ? kTwo54 : 1.0);
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(scaled) + (kOne - kRootHalf);
  // A number of less than 52 bits in the last places of 2^52 is that number.
  const double biased =
      std::bit_cast<double>((bits >> 52) | std::bit_cast<std::uint64_t>(kTwo52)) - kTwo52;
  const double k = biased - (small ? 1023.0 + 54 : 1023.0);
  const double f = std::bit_cast<double>((bits & kMantissa) + kRootHalf) - 1;
  const double z = f / (2 + f), zz = z * z;
  double series = 2.0 / 23;
  series = series * zz + 2.0 / 21;
  series = series * zz + 2.0 / 19;
  series = series * zz + 2.0 / 17;
  series = series * zz + 2.0 / 15;
  series = series * zz + 2.0 / 13;
  series = series * zz + 2.0 / 11;
  series = series * zz + 2.0 / 9;
  series = series * zz + 2.0 / 7;
  series = series * zz + 2.0 / 5;
  series = series * zz + 2.0 / 3;
  const double rest = z * (f - series * zz);  // ln m = f - z (f - series z^2)
  return (k * kLn2High - ((rest - k * kLn2Low) - f)) + (x - x);
}

/// Below it a ratio of volumes counts as none.
inline constexpr double kLeastVolume = std::numeric_limits<double>::min();

/// Cube root of x >= kLeastVolume, to two units in the last place. x = 2^(3 q + r) m with r one of
/// -1, 0, 1 and m about 1: a parabola for m, and Halley's step twice.
SUNDER_IN_LANES double cube_root(double x) {
  constexpr double kTwo52 = 0x1p52, kRound = 0x1.8p52;
  constexpr std::uint64_t kRootHalf = 0x3fe6a09e667f3bcd, kOne = 0x3ff0000000000000,
                          kMantissa = 0x000fffffffffffff;
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x) + (kOne - kRootHalf);
  const double k =
      std::bit_cast<double>((bits >> 52) | std::bit_cast<std::uint64_t>(kTwo52)) - kTwo52 - 1023;
  const double m = std::bit_cast<double>((bits & kMantissa) + kRootHalf);
  const double q = (k * (1.0 / 3) + kRound) - kRound, r = k - 3 * q;
  const double least = r < 0 ? 0x1.965fea53d6e3dp-1 : 1.0;
  const double part = r > 0 ? 0x1.428a2f98d728bp+0 : least;  // 2^(r/3)
  const double power =
      std::bit_cast<double>(std::bit_cast<std::uint64_t>(q + (kTwo52 + 1023)) << 52);
  const double f = m - 1;
  double root = 1 + f * (1.0 / 3 - f * (1.0 / 9));
  for (int step = 0; step < 2; ++step) {
    const double cube = root * root * root;
    root += root * ((m - cube) / (2 * cube + m));
  }
  return root * (part * power);
}

/// The nearest rotation, R of F = R S (singular_values.hpp), from the sum t = tr S of the singular
/// values with their signs. That is the largest root of
///   (t^2 - e)^2 - 8 J t - 4 k = 0,  e = |F|^2, k = |cof F|^2,
/// Horn's quartic (J. Opt. Soc. Am. A 4, 1987), whose other roots are t with two signs turned. It
/// is convex and grows beyond that root, so that Newton's method comes down to it from any bound.
/// R = dt/dF (Lin, Chitalu and Komura, "Isotropic ARAP energy using Cauchy-Green invariants", ACM
/// Trans. Graph. 41, 2022), by the derivative of the quartic:
///   R = ((t^2 + e) F + 2 t cof F - 2 F F^T F) / (t (t^2 - e) - 2 J).
/// The divisor is twice (s0 + s1)(s1 + s2)(s2 + s0): where it is small R is not to be had so.
struct Invariants {
  double square, cofactors, volume;  ///< e, k, J
};

SUNDER_IN_LANES Invariants invariants(const Matrix& f, const Matrix& of_cofactors) {
  return {inner(f, f), inner(of_cofactors, of_cofactors), determinant(f, of_cofactors)};
}

/// A sum and how far Newton's last step went, beside what it may be off.
struct Sum {
  double t, open;  ///< open <= 0: found
};

/// Least part of its largest possible value that the divisor may have: R is right to 2e-15 over it.
inline constexpr double kLeastDivisor = 0.1;
/// Of a step, as a part of t and of the divisor: what the next one leaves is its square.
inline constexpr double kLastStep = 1e-8;

SUNDER_IN_LANES double divisor(double t, const Invariants& of) {
  return t * (t * t - of.square) - 2 * of.volume;
}

SUNDER_IN_LANES Sum newton_step(double t, const Invariants& of) {
  const double w = t * t - of.square;
  const double slope = t * w - 2 * of.volume;  // a quarter of it
  const double over = (w * w - 8 * of.volume * t) - 4 * of.cofactors;
  const double step = 0.25 * over / slope;
  return {t - step, std::fabs(step) * of.square - kLastStep * slope};
}

/// s0 s1 + s1 s2 + s2 s0 is at most sqrt(3 k), and at most sqrt(k) where F is inverted; t^2 is e
/// and twice that. Four steps do where all s are positive and differ by no more than 40 times.
SUNDER_IN_LANES Sum sum_of_singular_values(const Invariants& of) {
  const double pairs = std::sqrt((of.volume > 0 ? 3.0 : 1.0) * of.cofactors);
  Sum sum{std::sqrt(of.square + 2 * pairs), 0};
  sum = newton_step(sum.t, of);
  sum = newton_step(sum.t, of);
  sum = newton_step(sum.t, of);
  return newton_step(sum.t, of);
}

struct Rotation {
  Matrix r;
  double weak;  ///< <= 0: right
};

SUNDER_IN_LANES Rotation rotation(const Matrix& f, const Matrix& of_cofactors, double t,
                                  const Invariants& of) {
  const Matrix cubic = times(f, cauchy_green(f));
  const double by = divisor(t, of), one = 1 / by;
  const double of_f = (t * t + of.square) * one, of_c = 2 * t * one, of_cubic = 2 * one;
  Rotation found;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      found.r.at[i][j] =
          (of_f * f.at[i][j] + of_c * of_cofactors.at[i][j]) - of_cubic * cubic.at[i][j];
    }
  }
  found.weak = kLeastDivisor * of.square * t - by;
  return found;
}

/// 1 - cos of a rotation's angle: grows with it, and small angles keep their digits.
SUNDER_IN_LANES double one_less_cosine(const Matrix& r) {
  const double cosine = 0.5 * (r.at[0][0] + r.at[1][1] + r.at[2][2] - 1);
  const double x = r.at[2][1] - r.at[1][2], y = r.at[0][2] - r.at[2][0],
               z = r.at[1][0] - r.at[0][1];
  const double above = 0.25 * (x * x + y * y + z * z) / (1 + cosine);
  return cosine > 0 ? above : 1 - cosine;
}

/// y of y^2 (y + 3) = 4 q with q = (1 + cos 3 a)/2 and 0 <= a <= 60 deg: 2 cos a = 1 + y. To 1e-7.
SUNDER_IN_LANES double double_cosine(double q) {
  q = q > 1e-30 ? q : 1e-30;
  const double root = std::sqrt(q);
  double y = root * (1.1547 - 0.1547 * root);
  y -= (y * y * (y + 3) - 4 * q) / (3 * y * (y + 2));
  y -= (y * y * (y + 3) - 4 * q) / (3 * y * (y + 2));
  return 1 + y;
}

/// Magnitude of the principal value of a symmetric tensor largest in magnitude, to 1e-7: with its
/// mean m and its deviator D they are m + sqrt(J2/3) 2 cos of three angles (Holzapfel 2000, 1.4).
SUNDER_IN_LANES double largest_principal(const Symmetric& s) {
  const double mean = (s.xx + s.yy + s.zz) / 3;
  const Symmetric d{s.xx - mean, s.yy - mean, s.zz - mean, s.xy, s.yz, s.zx};
  const double j2 = 0.5 * squared_norm(d), unit = std::sqrt(j2 / 3);
  const double cubed = unit * unit * unit;
  const double cosine = 0.5 * determinant(d) / (cubed > 1e-300 ? cubed : 1e-300);
  const double up = mean + unit * double_cosine(0.5 * (1 + cosine));
  const double down = unit * double_cosine(0.5 * (1 - cosine)) - mean;
  return up > down ? up : down;
}

/// What a law says of an element: energy per volume and first Piola-Kirchhoff stress.
struct Response {
  double energy;
  Matrix p;
};

/// law "linear".
SUNDER_IN_LANES Response linear(double mu, double lambda, const Matrix& f) {
  const auto& a = f.at;
  const Symmetric e{a[0][0] - 1,
                    a[1][1] - 1,
                    a[2][2] - 1,
                    0.5 * (a[0][1] + a[1][0]),
                    0.5 * (a[1][2] + a[2][1]),
                    0.5 * (a[2][0] + a[0][2])};
  const double trace = e.xx + e.yy + e.zz, pressure = lambda * trace, twice = 2 * mu;
  const double xy = twice * e.xy, yz = twice * e.yz, zx = twice * e.zx;
  return {mu * squared_norm(e) + 0.5 * pressure * trace,
          {{{pressure + twice * e.xx, xy, zx},
            {xy, pressure + twice * e.yy, yz},
            {zx, yz, pressure + twice * e.zz}}}};
}

/// law "corotated"; |S - I| = |F - R|.
SUNDER_IN_LANES Response corotated(double mu, double lambda, const Matrix& f, const Matrix& r,
                                   double trace) {
  const double dilation = trace - 3, pressure = lambda * dilation, twice = 2 * mu;
  Matrix apart, p;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      apart.at[i][j] = f.at[i][j] - r.at[i][j];
      p.at[i][j] = twice * apart.at[i][j] + pressure * r.at[i][j];
    }
  }
  return {mu * inner(apart, apart) + 0.5 * pressure * dilation, p};
}

/// law "neo-hookean".
SUNDER_IN_LANES Response neo_hookean(double mu, double lambda, const Matrix& f) {
  const Matrix of_cofactors = cofactor(f);
  const double j = determinant(f, of_cofactors), dilation = log(j);
  const double pressure = lambda * dilation, by = (pressure - mu) / j;
  const double energy = (0.5 * mu * (inner(f, f) - 3) - mu * dilation) + 0.5 * pressure * dilation;
  Response found;
  found.energy = j > 0 ? energy : std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      found.p.at[i][k] = mu * f.at[i][k] + by * of_cofactors.at[i][k];
    }
  }
  return found;
}

/// The part of law "neo-hookean" that shape decides, with a pressure that is given.
SUNDER_IN_LANES Response neo_hookean_shape(double mu, double pressure, const Matrix& f) {
  const Matrix of_cofactors = cofactor(f);
  const double j = determinant(f, of_cofactors), side = cube_root(j);
  const double by = pressure - mu / side;
  const double energy = 0.5 * mu * (inner(f, f) - 3 * (side * side));
  Response found;
  found.energy = j >= kLeastVolume ? energy : std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      found.p.at[i][k] = mu * f.at[i][k] + by * of_cofactors.at[i][k];
    }
  }
  return found;
}

/// law "saint-venant-kirchhoff".
SUNDER_IN_LANES Response saint_venant_kirchhoff(double mu, double lambda, const Matrix& f) {
  const Symmetric c = cauchy_green(f);
  const Symmetric e{0.5 * (c.xx - 1), 0.5 * (c.yy - 1), 0.5 * (c.zz - 1),
                    0.5 * c.xy,       0.5 * c.yz,       0.5 * c.zx};
  const double trace = e.xx + e.yy + e.zz, pressure = lambda * trace, twice = 2 * mu;
  const Symmetric s{pressure + twice * e.xx,
                    pressure + twice * e.yy,
                    pressure + twice * e.zz,
                    twice * e.xy,
                    twice * e.yz,
                    twice * e.zx};
  return {mu * squared_norm(e) + 0.5 * pressure * trace, times(f, s)};
}

}  // namespace sunder::lanes
