// SPDX-License-Identifier: Apache-2.0
// A tip's domain turned back by its own rotation (method.md "Field K", Finite deformation): where
// little else is left the theory of small strains, and with it the interaction integral, speaks of
// it.
#pragma once

#include <span>

#include "fracture/field_sif/tip_domain.hpp"
#include "sunder/problem.hpp"

namespace sunder::fracture {

struct TurnedBack {
  Mat3 rotation = Mat3::Identity();  ///< of the domain: nearest to its mean F
  /// What is left in the worst element: principal value of U - I, angle.
  double strain = 0, rotation_deg = 0;
};

/// Replaces the displacement u of the domain's nodes by R^T (X + u) - X.
TurnedBack turn_back(const Problem& problem, const TipDomain& domain, std::span<Vec3> displacement);

}  // namespace sunder::fracture
