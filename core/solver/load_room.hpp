// SPDX-License-Identifier: Apache-2.0
// Room for copies of a load, so that a frame whose load turns allocates nothing.
#pragma once

#include <cstddef>

#include "sunder/backend.hpp"

namespace sunder::solver {

/// Forces of the largest load that a scene's instruments, or a question about one of its elements
/// (attribution.hpp), can bring.
[[nodiscard]] std::size_t most_forces(const Problem& problem);

void reserve(Load& load, const Problem& problem);

}  // namespace sunder::solver
