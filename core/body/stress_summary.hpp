// SPDX-License-Identifier: Apache-2.0
// What a frame needs to know of all stresses: the worst ratios to strength.
#pragma once

#include <cstdint>
#include <span>

#include "sunder/backend.hpp"

namespace sunder::fem {

/// Worst ratio of the yield measure over live breakable elements, and over those not excluded.
[[nodiscard]] StressSummary summarize(const Problem& problem,
                                      std::span<const std::uint8_t> destroyed,
                                      std::span<const std::uint8_t> excluded,
                                      std::span<const Voigt> stress);

}  // namespace sunder::fem
