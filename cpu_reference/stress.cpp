// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/stress.hpp"

#include "body/pools.hpp"

namespace sunder::cpu_reference {

void element_stress(const Problem& problem, std::span<const double> scale,
                    std::span<const double> u, std::span<Voigt> stress) {
  const fem::StressField field(problem, scale, u);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    stress[e] = scale[e] * field.of(e);
  }
}

}  // namespace sunder::cpu_reference
