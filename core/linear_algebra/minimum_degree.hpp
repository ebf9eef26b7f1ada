// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::linear_algebra {

/// Which of `count` points is eliminated first, second and so on, by approximate minimum degree.
/// `edges`: both ways, a point's own too; may repeat.
[[nodiscard]] std::vector<Index> minimum_degree_order(
    Index count, std::span<const std::pair<Index, Index>> edges);

}  // namespace sunder::linear_algebra
