// SPDX-License-Identifier: Apache-2.0
// What K at a notch's tip owes to where the mesh lets the notch end (method.md "Field K"). Linear
// elements hold a sharp tip too stiffly, as if it ended a part of h further back; a blunt root acts
// as if it ended further ahead. Either adds a field ~ r^(-1/2) to the displacement, which no crack
// has that ends at the tip. What such a field brings into K is found once, from the body loaded at
// the tip alone, and taken off.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/field_sif/interaction_integral.hpp"
#include "sunder/crack.hpp"
#include "sunder/problem.hpp"

namespace sunder::fracture {

/// Measured at one tip.
struct ShiftedIntensity {
  IntensityFactors factors;
  IntensityFactors shift;  ///< factors times the distance at which the crack ends behind the tip
};

/// Reads a tip of the crack in a displacement of all nodes, shape (3 * nodes).
using MeasureTip = std::function<ShiftedIntensity(std::size_t, std::span<const double>)>;

/// K at each tip of a crack per shift at each, shape (3 tips x 3 tips), in the undamaged body whose
/// presets have taken their elements; grips hold. Empty where no elements are within `reach` [mm]
/// of a tip.
[[nodiscard]] Eigen::MatrixXd intensity_per_shift(const Problem& problem, const Board& board,
                                                  const Crack& crack, double reach,
                                                  const MeasureTip& measure);

}  // namespace sunder::fracture
