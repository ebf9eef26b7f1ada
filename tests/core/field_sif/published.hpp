// SPDX-License-Identifier: Apache-2.0
// Published stress intensity factors as formulas.
#pragma once

#include <cmath>
#include <numbers>

namespace sunder::test {

/// Single edge notch in tension, F(a/W) with K = F s sqrt(pi a): Tada, Paris, Irwin, The Stress
/// Analysis of Cracks Handbook; better than 0.5 % for any a/W.
inline double tada_edge(double x) {
  const double t = std::numbers::pi * x / 2;
  return std::sqrt(std::tan(t) / t) * (0.752 + 2.02 * x + 0.37 * std::pow(1 - std::sin(t), 3)) /
         std::cos(t);
}

/// The same from a singular integral equation, exact to the digits printed (Kaya and Erdogan 1987,
/// Quarterly of Applied Mathematics 45:105); a/W = .1 to .6.
inline double kaya_erdogan_edge(int tenths) {
  constexpr double kFactor[] = {1.1892, 1.3673, 1.6599, 2.1114, 2.8246, 4.0332};
  return kFactor[tenths - 1];
}

/// Edge crack under antiplane shear in a strip, K_III / (t sqrt(pi a)); exact (Tada, Paris, Irwin).
inline double antiplane_edge(double x) {
  const double t = std::numbers::pi * x / 2;
  return std::sqrt(std::tan(t) / t);
}

/// The same as a polynomial, 0.5 % up to a/W = 0.6 (Gross and Srawley 1964; Brown and Srawley
/// 1966).
inline double polynomial_edge(double x) {
  return 1.12 + x * (-0.231 + x * (10.55 + x * (-21.72 + x * 30.39)));
}

/// Centre crack of length 2a in a strip 2W wide: Tada's modification of Feddersen's formula; 0.1 %
/// for any a/W.
inline double tada_centre(double x) {
  return (1 - 0.025 * x * x + 0.06 * std::pow(x, 4)) /
         std::sqrt(std::cos(std::numbers::pi * x / 2));
}

/// Two pairs of forces P [N/mm] that open an internal crack of length 2a at +-b in an infinite
/// plane; one pair at b = 0.
inline double force_pair(double p, double a, double b) {
  if (b == 0) return p / std::sqrt(std::numbers::pi * a);
  return 2 * p * std::sqrt(a / std::numbers::pi) / std::sqrt(a * a - b * b);
}

}  // namespace sunder::test
