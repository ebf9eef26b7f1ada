// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/stress.hpp"

#include <algorithm>
#include <cmath>

#include "body/element.hpp"
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

}  // namespace sunder::cpu_reference
