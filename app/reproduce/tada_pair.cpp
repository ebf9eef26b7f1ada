// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/tada_pair.hpp"

#include <cmath>
#include <numbers>

namespace sunder::app::reproduce {

double tada_pair(double distance, double length, double width) {
  const double c = 1 - distance / length, x = length / width;  // c: from the mouth, over the length
  const double near_tip = (1.30 - 0.30 * std::pow(c, 1.5)) / std::sqrt(1 - c * c);
  const double factor = 3.52 * (1 - c) / std::pow(1 - x, 1.5) -
                        (4.35 - 5.28 * c) / std::sqrt(1 - x) +
                        (near_tip + 0.83 - 1.76 * c) * (1 - (1 - c) * x);
  return 2 * factor / std::sqrt(std::numbers::pi * length);
}

double tada_turn(double length, double width) {
  constexpr int kPlaces = 1000;
  int least = 1;
  for (int i = 2; i <= kPlaces; ++i) {
    const double here = tada_pair(length * i / kPlaces, length, width);
    if (here < tada_pair(length * least / kPlaces, length, width)) least = i;
  }
  return static_cast<double>(least) / kPlaces;
}

}  // namespace sunder::app::reproduce
