// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/tangential_stress.hpp"

#include <algorithm>
#include <cmath>

namespace sunder::fracture {

double tangential_angle(double k_1, double k_2) {
  const double opening = std::max(k_1, 0.0);
  // K_I sin(theta) + K_II (3 cos(theta) - 1) = 0, solved for tan(theta/2) without cancellation.
  const double sum = opening + std::sqrt(opening * opening + 8 * k_2 * k_2);
  return sum > 0 ? 2 * std::atan(-2 * k_2 / sum) : 0.0;
}

double tangential_intensity(double k_1, double k_2, double theta) {
  const double c = std::cos(theta / 2);
  return std::max(k_1, 0.0) * c * c * c - 1.5 * k_2 * c * std::sin(theta);
}

}  // namespace sunder::fracture
