// SPDX-License-Identifier: Apache-2.0
// X_SS of a damaged body from that of the body before: a dense update of the rank that the damage
// has gathered, each column refined as a solution is (deferred.hpp), so that updates on top of one
// another hardly drift.
#pragma once

#include "solver/condensed_base.hpp"
#include "solver/deferred.hpp"

namespace sunder::solver {

/// Shape (|S| x |S|), S = state.dofs, symmetric. What an inverse that was updated before lacks
/// grows with the forces of the damage, base by base: the columns that the damage acts through, and
/// those of the unknowns `loaded`, are first made exact by the factor and what was lost since.
/// Others wait until damage comes to them. Cost some |S|^2 r / 2 + 4 |S| r^2 multiply-adds, and up
/// to 2 |S| |T| r for the columns, T the unknowns of what was lost. The bits do not depend on how
/// many threads share it; throws linear_algebra::Stopped when the work was given up.
[[nodiscard]] Eigen::MatrixXd updated_inverse(const CondensedState& state,
                                              const DamageMatrices& damage,
                                              std::span<const Index> loaded = {},
                                              const linear_algebra::FactorWork& work = {});

}  // namespace sunder::solver
