// SPDX-License-Identifier: Apache-2.0
#include "body/analysis.hpp"

#include "body/assembly.hpp"
#include "body/stiffness_factor.hpp"

namespace sunder::fem {

std::unique_ptr<const Analysis> analyse(const Problem& problem) {
  auto analysis = std::make_unique<Analysis>();
  analysis->nodes =
      std::make_shared<const linear_algebra::Supernodes>(linear_algebra::find_supernodes(
          assemble_lower(problem, {}), elimination_order(problem), analysis->ordered));
  return analysis;
}

}  // namespace sunder::fem
