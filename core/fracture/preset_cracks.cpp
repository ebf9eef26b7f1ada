// SPDX-License-Identifier: Apache-2.0
#include "fracture/preset_cracks.hpp"

namespace sunder::fracture {

std::vector<DestroyedElement> preset_elements(const Problem& problem) {
  std::vector<DestroyedElement> rows;
  const auto& cracks = problem.crack_elements();
  for (std::size_t c = 0; c < cracks.size(); ++c) {
    for (Index e : cracks[c]) {
      DestroyedElement row;
      row.element = e;
      row.cause = Cause::preset;
      row.crack = static_cast<int>(c);
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace sunder::fracture
