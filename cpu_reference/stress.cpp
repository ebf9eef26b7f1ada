// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/stress.hpp"

#include <algorithm>
#include <cmath>

#include "fem/element.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::cpu_reference {

void element_stress(const Problem& problem, std::span<const double> scale,
                    std::span<const double> u, std::span<Voigt> stress) {
  for (Index e = 0; e < problem.tet_count(); ++e) {
    stress[e] = scale[e] * fem::stress(problem, e, u);
  }
}

StressSummary summarize(const Problem& problem, std::span<const std::uint8_t> destroyed,
                        std::span<const std::uint8_t> excluded, std::span<const Voigt> stress) {
  const YieldMeasure measure = strength_measure(problem.scene().fracture);
  StressSummary summary;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (destroyed[e] || !problem.breakable(e)) continue;
    const double ratio = yield_measure(stress[e], measure) / problem.yield(e);
    if (ratio > summary.any.ratio) summary.any = {e, ratio};
    if (ratio >= 1) ++summary.over;
    if (!excluded[e] && ratio > summary.candidate.ratio) summary.candidate = {e, ratio};
  }
  return summary;
}

namespace {

/// Square of the stress tensor's Frobenius norm.
double squared_stress(const Problem& problem, Index e, std::span<const double> u) {
  const Voigt s = fem::stress(problem, e, u);
  return s.head<3>().squaredNorm() + 2 * s.tail<3>().squaredNorm();
}

/// Over the elements element(0) ... element(count - 1).
template <class Element>
double largest_of(const Problem& problem, std::span<const std::uint8_t> destroyed,
                  std::span<const double> u, std::size_t count, Element&& element) {
  double largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Index e = element(i);
    if (destroyed[e]) continue;
    const double squared = squared_stress(problem, e, u);
    if (!std::isfinite(squared)) return squared;
    largest = std::max(largest, squared);
  }
  return std::sqrt(largest);
}

}  // namespace

double largest_stress(const Problem& problem, std::span<const std::uint8_t> destroyed,
                      std::span<const double> u) {
  return largest_of(problem, destroyed, u, destroyed.size(),
                    [](std::size_t i) { return static_cast<Index>(i); });
}

double largest_stress(const Problem& problem, std::span<const std::uint8_t> destroyed,
                      std::span<const double> u, std::span<const Index> elements) {
  return largest_of(problem, destroyed, u, elements.size(),
                    [&](std::size_t i) { return elements[i]; });
}

}  // namespace sunder::cpu_reference
