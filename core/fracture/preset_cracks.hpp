// SPDX-License-Identifier: Apache-2.0
// The preset cracks of a scene, the same under every fracture model: their elements are gone from
// the start, and instruments can press on their faces.
#pragma once

#include <vector>

#include "fracture/criterion.hpp"

namespace sunder::fracture {

/// Rows of event 0: the elements of all presets in crack order.
[[nodiscard]] std::vector<DestroyedElement> preset_elements(const Problem& problem);

}  // namespace sunder::fracture
