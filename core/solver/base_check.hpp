// SPDX-License-Identifier: Apache-2.0
// What is known of a base before a frame uses it.
#pragma once

#include "sunder/backend.hpp"

namespace sunder::solver {

/// What the full check of a base (frame_check.hpp) has found: for which load, how much stress [MPa]
/// a residual of 1 N is worth (0: there was no check), and the error of the stress as it came.
struct BaseCheck {
  Load load;
  double stress_of_residual = 0, error = 0;
};

}  // namespace sunder::solver
