// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/stress.hpp"

#include "body/element.hpp"

namespace sunder::cpu_reference {

void element_stress(const Problem& problem, std::span<const double> scale,
                    std::span<const double> u, std::span<Voigt> stress) {
  for (Index e = 0; e < problem.tet_count(); ++e) {
    stress[e] = scale[e] * fem::stress(problem, e, u);
  }
}

}  // namespace sunder::cpu_reference
