// SPDX-License-Identifier: Apache-2.0
// How a tip wants to grow by the K measured from the field (method.md "Field K").
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fracture/field_sif/field_intensity.hpp"
#include "fracture/tip_growth.hpp"

namespace sunder::fracture {

/// K and direction of one tip by the largest tangential stress; none when nothing opens it. The
/// terms keep what the formula says (`formula`, if it says anything).
[[nodiscard]] std::optional<TipGrowth> field_growth(FieldIntensityMeter& meter, const Crack& crack,
                                                    std::size_t tip,
                                                    const std::optional<TipGrowth>& formula,
                                                    const FractureState& state,
                                                    std::vector<std::string>& warnings);

}  // namespace sunder::fracture
