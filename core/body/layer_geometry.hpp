// SPDX-License-Identifier: Apache-2.0
// Which way the layers of interfaces lie: from their first volume to their second.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::fem {

/// Nodes of elements of a volume: those of an interface's second side are what those of its first
/// are not.
[[nodiscard]] std::vector<std::uint8_t> nodes_of_volume(const Mesh& mesh, const std::string& name);

/// Gradient of what is 0 on the nodes of the first volume and 1 on the others [1/mm]: across the
/// layer, as steep as it is thin.
[[nodiscard]] Vec3 slope_across(const TetShape& shape, const std::array<Index, 4>& tet,
                                const std::vector<std::uint8_t>& first);

}  // namespace sunder::fem
