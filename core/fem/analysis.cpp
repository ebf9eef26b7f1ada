// SPDX-License-Identifier: Apache-2.0
#include "fem/analysis.hpp"

#include "fem/nested_dissection.hpp"

namespace sunder::fem {

std::unique_ptr<const Analysis> analyse(const Problem& problem) {
  auto analysis = std::make_unique<Analysis>();
  analysis->nodes = std::make_shared<const Supernodes>(
      find_supernodes(assemble_lower(problem, {}), nested_dissection(problem), analysis->ordered));
  return analysis;
}

}  // namespace sunder::fem
