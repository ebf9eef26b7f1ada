// SPDX-License-Identifier: Apache-2.0
// Order of elimination of a body's unknowns. Nested dissection (George 1973) leaves a factor with
// about as many entries as minimum degree on a thin board, a third of the operations on a thick
// one, and elimination paths half as long: an event reads those.
#pragma once

#include <vector>

#include "sunder/problem.hpp"

namespace sunder::fem {

/// place[i] is the row of the factor that unknown i becomes. Planes across the body separate its
/// nodes, small pieces are ordered by minimum degree; a node's unknowns stay together.
[[nodiscard]] std::vector<Index> nested_dissection(const Problem& problem);

}  // namespace sunder::fem
