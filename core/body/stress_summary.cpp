// SPDX-License-Identifier: Apache-2.0
#include "body/stress_summary.hpp"

#include "sunder/fracture_model.hpp"

namespace sunder::fem {

StressSummary summarize(const Problem& problem, std::span<const std::uint8_t> destroyed,
                        std::span<const std::uint8_t> excluded, std::span<const Voigt> stress) {
  const YieldMeasure measure = strength_measure(problem.scene().fracture);
  StressSummary summary;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (destroyed[e] || !problem.breakable(e)) continue;
    const double ratio = problem.yield_ratio(e, stress[e], measure);
    if (ratio > summary.any.ratio) summary.any = {e, ratio};
    if (ratio >= 1) ++summary.over;
    if (!excluded[e] && ratio > summary.candidate.ratio) summary.candidate = {e, ratio};
  }
  return summary;
}

}  // namespace sunder::fem
