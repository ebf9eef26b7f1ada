// SPDX-License-Identifier: Apache-2.0
// Route condensed: the deferred update over X_SS (condensed_base.hpp), whose base is made anew
// beside the frames from the last one.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <span>

#include "body/damaged_body.hpp"
#include "solver/inverse_route.hpp"
#include "solver/region_product.hpp"

namespace sunder::solver {

/// Over the unknowns S = `dofs` (ascending), by the intact body's factor. The body must outlive it.
/// `rest`: of the thread that makes new bases (background_rebase.hpp). `product`: takes what it can
/// of every frame's product with X_SS, and outlives the route; null: nobody. `solver`: likewise, of
/// the solutions by the small matrices. `most`: S grows where
/// something is destroyed or grasped beyond it, and once it has more unknowns the next base is made
/// by a factor over `dofs` alone; none: some thousand more, by what such a base costs.
[[nodiscard]] std::unique_ptr<InverseRoute> condensed_route(
    const fem::DamagedBody& body, std::shared_ptr<const linear_algebra::Factor> intact,
    std::span<const Index> dofs, bool damage, std::chrono::milliseconds rest,
    RegionProduct* product = nullptr, DamageSolver* solver = nullptr,
    std::optional<std::size_t> most = {});

/// S grows where a host goes. Once it has more unknowns than this, beside those that are gripped,
/// the next base is made by a factor, over what S was at first, of `dofs` unknowns: an hour of cuts
/// costs no more memory than minutes.
[[nodiscard]] std::size_t most_unknowns(std::size_t dofs);

/// Columns of X_SS B that a base of so many unknowns is expected to come to.
[[nodiscard]] Index columns_of_a_base(std::size_t dofs);

}  // namespace sunder::solver
