// SPDX-License-Identifier: Apache-2.0
// How far a body of finite deformation is deformed: strain U - I and rotation of F = R U.
#pragma once

#include <functional>
#include <span>

#include "sunder/backend.hpp"

namespace sunder::fem {

/// Over the elements that `counts` says, at the displacement u (3 * nodes): the principal value of
/// U - I largest in magnitude, of two as large the first; the largest rotation; how many have
/// det F <= 0.
[[nodiscard]] Deformation finite_deformation(const Problem& problem, std::span<const double> u,
                                             const std::function<bool(Index)>& counts);

}  // namespace sunder::fem
