// SPDX-License-Identifier: Apache-2.0
#include "fracture/kinked_crack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

constexpr double kPi = std::numbers::pi, kPi2 = kPi * kPi, kPi3 = kPi * kPi2, kPi4 = kPi2 * kPi2;
constexpr double kPi5 = kPi * kPi4, kPi6 = kPi2 * kPi4;

/// sum of c_i x^i
template <std::size_t N>
double polynomial(const std::array<double, N>& c, double x) {
  double sum = 0;
  for (std::size_t i = N; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

// By m = theta/pi: F_11 and F_22 in m^2, F_12 and F_21 in m^2 times m.
constexpr std::array<double, 11> kF11{1,
                                      -3 * kPi2 / 8,
                                      kPi2 - 5 * kPi4 / 128,
                                      kPi2 / 9 - 11 * kPi4 / 72 + 119 * kPi6 / 15360,
                                      5.07790,
                                      -2.88312,
                                      -0.0925,
                                      2.996,
                                      -4.059,
                                      1.63,
                                      4.1};
constexpr std::array<double, 10> kF12{-3 * kPi / 2,
                                      10 * kPi / 3 + kPi3 / 16,
                                      -2 * kPi - 133 * kPi3 / 180 + 59 * kPi5 / 1280,
                                      12.313906,
                                      -7.32433,
                                      1.5793,
                                      4.0216,
                                      -6.915,
                                      4.21,
                                      4.56};
constexpr std::array<double, 10> kF21{kPi / 2,
                                      -4 * kPi / 3 - kPi3 / 48,
                                      -2 * kPi / 3 + 13 * kPi3 / 30 - 59 * kPi5 / 3840,
                                      -6.176023,
                                      4.44112,
                                      -1.5340,
                                      -2.0700,
                                      4.684,
                                      -3.95,
                                      -1.32};
constexpr std::array<double, 11> kF22{
    1,
    -4 - 3 * kPi2 / 8,
    8.0 / 3 + 29 * kPi2 / 18 - 5 * kPi4 / 128,
    -32.0 / 15 - 4 * kPi2 / 9 - 1159 * kPi4 / 7200 + 119 * kPi6 / 15360,
    10.58254,
    -4.78511,
    -1.8804,
    7.280,
    -7.591,
    0.25,
    12.5};

}  // namespace

KinkIntensity kinked(double k_1, double k_2, double theta) {
  const double m = theta / kPi, m2 = m * m, opening = std::max(k_1, 0.0);
  return {polynomial(kF11, m2) * opening + m * polynomial(kF12, m2) * k_2,
          m * polynomial(kF21, m2) * opening + polynomial(kF22, m2) * k_2};
}

std::optional<Turn> easiest_turn(double k_1, double k_2, const Vec2& direction,
                                 const TipResistance& resistance) {
  constexpr int kTurns = 160;  // a degree each
  constexpr int kHalvings = 40;
  const auto ratio = [&](double theta) {
    const KinkIntensity k = kinked(k_1, k_2, theta);
    return k.k_1 > 0 ? k.squared() / resistance.squared(turned(direction, theta)) : 0.0;
  };
  const double step = 2 * kLargestKink / kTurns;
  // From straight on to both sides, so that of equal turns the smallest is taken.
  double best = ratio(0), theta = 0;
  for (int i = 1; i <= kTurns / 2; ++i) {
    for (const double turn : {-i * step, i * step}) {
      const double there = ratio(turn);
      if (there > best * (1 + 1e-12)) {
        best = there;
        theta = turn;
      }
    }
  }
  if (!(best > 0)) return std::nullopt;
  double width = step / 2;
  for (int i = 0; i < kHalvings; ++i, width /= 2) {
    for (const double turn : {theta - width, theta + width}) {
      if (std::abs(turn) > kLargestKink) continue;
      if (const double there = ratio(turn); there > best) {
        best = there;
        theta = turn;
        break;
      }
    }
  }
  return Turn{theta, std::sqrt(kinked(k_1, k_2, theta).squared())};
}

}  // namespace sunder::fracture
