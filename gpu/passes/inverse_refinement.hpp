// SPDX-License-Identifier: Apache-2.0
// What rounding of an assembled K costs its inverse, which elements beside far stiffer ones feel
// most, taken out once: X += X (I - K X), K u summed by elements. A step of Newton's method for an
// inverse (Schulz, Z. Angew. Math. Mech. 13, 1933): 2 n^3 flops, half as many digits more.
#pragma once

#include "body/damaged_body.hpp"
#include "gpu/passes/dense_inverse.hpp"

namespace sunder::gpu {

/// I - K X at the columns of some unknowns, `columns` those of X, by elements; shape of both
/// (n x unknowns).
void unit_residuals(const fem::DamagedBody& body, std::span<const Index> dofs,
                    const Eigen::Ref<const Eigen::MatrixXd>& columns, Eigen::MatrixXd& residuals);

/// Refines X of that body, stored in fp64 and not updated.
void refine_inverse(const KernelFactory& kernels, const fem::DamagedBody& body, std::uint32_t rows,
                    DenseInverse& inverse);

/// Device bytes of that beside the inverse, before they exist.
[[nodiscard]] std::size_t planned_refinement_bytes(std::uint32_t rows);

}  // namespace sunder::gpu
