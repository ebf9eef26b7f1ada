// SPDX-License-Identifier: Apache-2.0
// The project's two error measures: displacement in the 2-norm over nodes of live elements, stress
// as the largest difference over the largest stress, over live elements.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sunder/mesh.hpp"

namespace sunder::test {

/// Frobenius norm of the tensor.
inline double tensor_norm(const Voigt& s) {
  return std::sqrt(s.head<3>().squaredNorm() + 2 * s.tail<3>().squaredNorm());
}

/// `ignored` is 1 for elements that do not count: destroyed ones, or a piece cut off.
inline double displacement_error(const Mesh& mesh, std::span<const std::uint8_t> ignored,
                                 std::span<const double> u, std::span<const double> reference) {
  std::vector<std::uint8_t> counts(mesh.nodes.size(), 0);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    if (ignored[e]) continue;
    for (Index n : mesh.tets[e]) counts[static_cast<std::size_t>(n)] = 1;
  }
  double difference = 0, norm = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (!counts[i / 3]) continue;
    difference += (u[i] - reference[i]) * (u[i] - reference[i]);
    norm += reference[i] * reference[i];
  }
  return std::sqrt(difference / norm);
}

inline double stress_error(std::span<const std::uint8_t> ignored, std::span<const Voigt> stress,
                           std::span<const Voigt> reference) {
  double difference = 0, largest = 0;
  for (std::size_t e = 0; e < stress.size(); ++e) {
    if (ignored[e]) continue;
    const double d = tensor_norm(stress[e] - reference[e]);
    if (!std::isfinite(d)) return d;
    difference = std::max(difference, d);
    largest = std::max(largest, tensor_norm(reference[e]));
  }
  return difference / largest;
}

// Accuracy promised in double precision by every route and update.
inline constexpr double kIntactTolerance = 1e-9;  ///< intact and scattered damage
inline constexpr double kCrackTolerance = 1e-8;   ///< along a crack, up to 200 fractures
inline constexpr double kCutTolerance = 1e-5;     ///< attached part after a cut
// Fp32 storage by the mixed recipe, any damage.
inline constexpr double kFp32Tolerance = 1e-4;

}  // namespace sunder::test
