// SPDX-License-Identifier: Apache-2.0
// The stiffness of the whole body: assembled for factorisations, applied element by element where
// the product itself must be exact.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "body/change.hpp"
#include "body/element.hpp"
#include "linear_algebra/sparse_matrix.hpp"
#include "sunder/problem.hpp"

namespace sunder::fem {

/// Stiffness over the unknowns, shape (dof_count x dof_count), lower triangle only, anchors
/// included. `scale` multiplies each element's K_e (its a_e); empty: intact. `pools`: patches of
/// pooled volume as damage has split them; null: the problem's.
[[nodiscard]] linear_algebra::SparseMatrix assemble_lower(const Problem& problem,
                                                          std::span<const double> scale,
                                                          const Pools* pools = nullptr);
/// The same of any element matrices, symmetric; entries that are 0 have their place too.
[[nodiscard]] linear_algebra::SparseMatrix assemble_elements(
    const Problem& problem, const std::function<ElementMatrix(Index)>& matrix_of);
/// Of forms that are not the mesh's alone, their corners nodes of the mesh; anchors are left out.
[[nodiscard]] linear_algebra::SparseMatrix assemble_forms(const Problem& problem,
                                                          std::span<const Form> forms);

/// y = K u over all 3 * node_count entries, supports included (there y is minus the support's
/// force), anchors left out. Element by element, with `scale` and `pools` as above: no
/// cancellation between a destroyed element's stiffness and its neighbours'.
void apply_stiffness(const Problem& problem, std::span<const double> scale,
                     std::span<const double> u, std::span<double> y, const Pools* pools = nullptr);

/// Copies unknowns to node layout (0 at supports) and back.
void scatter(const Problem& problem, std::span<const double> unknowns, std::span<double> nodal);
void gather(const Problem& problem, std::span<const double> nodal, std::span<double> unknowns);

}  // namespace sunder::fem
