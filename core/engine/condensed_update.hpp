// SPDX-License-Identifier: Apache-2.0
// X_SS of a damaged body from that of the body before: a dense update of the rank that the damage
// has gathered, each column refined as a solution is (deferred.hpp), so that updates on top of one
// another hardly drift.
#pragma once

#include "engine/condensed_base.hpp"
#include "engine/deferred.hpp"

namespace sunder::engine {

/// Shape (|S| x |S|), S = state.dofs. Cost some |S|^2 r + 5 |S| r^2 multiply-adds.
[[nodiscard]] Eigen::MatrixXd updated_inverse(const CondensedState& state, const Damage& damage);

}  // namespace sunder::engine
