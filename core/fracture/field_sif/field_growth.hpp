// SPDX-License-Identifier: Apache-2.0
// How a tip wants to grow by the K measured from the field (method.md "Field K").
#pragma once

#include <optional>
#include <vector>

#include "fracture/field_sif/field_intensity.hpp"
#include "fracture/tip_growth.hpp"

namespace sunder::fracture {

/// Measures one tip and writes what the field says into `terms` (K_I to K_III, and K and theta by
/// the largest tangential stress, or by energy where tissue resists by direction), beside what
/// drives the tip. Returns theta [rad] from the tip's direction; none when nothing opens the crack.
std::optional<double> add_field_terms(FieldIntensityMeter& meter, const Crack& crack,
                                      std::size_t tip, const FieldView& view, SifTerms& terms,
                                      std::vector<Finding>& findings);

/// K and direction of one tip by the field; none when nothing opens it. The terms of Eq. 2 to 4 are
/// left at 0.
[[nodiscard]] std::optional<TipGrowth> field_growth(FieldIntensityMeter& meter, const Crack& crack,
                                                    std::size_t tip, const FieldView& view,
                                                    std::vector<Finding>& findings);

/// What the field says of a tip, as tips.csv has it.
void add_field_state(FieldIntensityMeter& meter, const Crack& crack, std::size_t tip,
                     const FieldView& view, TipState& state, std::vector<Finding>& findings);

}  // namespace sunder::fracture
