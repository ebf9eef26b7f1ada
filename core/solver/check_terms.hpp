// SPDX-License-Identifier: Apache-2.0
// What both checks of a frame (frame_check.hpp, energy_check.hpp) reckon with.
#pragma once

#include <optional>

#include "sunder/backend.hpp"

namespace sunder::solver {

/// s > 0 with a = s b, but for the rounding of a ramp; nothing: a has another direction.
[[nodiscard]] std::optional<double> multiple(const Load& a, const Load& b);

}  // namespace sunder::solver
