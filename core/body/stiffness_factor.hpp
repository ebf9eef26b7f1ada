// SPDX-License-Identifier: Apache-2.0
// Factor of a body's stiffness, in an order that its geometry gives.
#pragma once

#include <span>
#include <vector>

#include "body/damaged_body.hpp"
#include "linear_algebra/factor.hpp"
#include "sunder/problem.hpp"

namespace sunder::fem {

/// The row of the factor that each unknown becomes, by nested dissection.
[[nodiscard]] std::vector<Index> elimination_order(const Problem& problem);

/// Elements scaled as in assemble_lower. Throws as Factor's constructors do.
[[nodiscard]] linear_algebra::Factor factor_stiffness(const Problem& problem,
                                                      std::span<const double> scale = {},
                                                      const linear_algebra::FactorWork& work = {});
/// Of a body as it is.
[[nodiscard]] linear_algebra::Factor factor_stiffness(const DamagedBody& body,
                                                      const linear_algebra::FactorWork& work = {});

}  // namespace sunder::fem
