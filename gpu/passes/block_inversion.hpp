// SPDX-License-Identifier: Apache-2.0
// A dense inverse computed on the device, in fp64 whatever it is stored in (computed in fp32 it
// loses 1 to 33 % of u; stored in fp32, 1e-7 to 6e-5).
#pragma once

#include "gpu/passes/dense_inverse.hpp"
#include "linear_algebra/factor.hpp"

namespace sunder::gpu {

/// inverse = A^-1 for the symmetric positive definite A whose lower triangle is given. Symmetric
/// block Gauss-Jordan: n / 60 updates of rank 60, n^3 fp64 multiply-adds, in place where `inverse`
/// is stored in fp64, else by 8 n^2 bytes beside it. Throws NumericalError when A is not positive
/// definite in fp64.
void invert_on_device(const KernelFactory& kernels, const linear_algebra::SparseMatrix& lower,
                      std::uint32_t rows, std::size_t panel_bytes, DenseInverse& inverse);

/// Device bytes of that beside an inverse stored by such kernels, before they exist.
[[nodiscard]] std::size_t planned_inversion_bytes(const KernelFactory& stored, Index n,
                                                  std::uint32_t rows, std::size_t panel_bytes);

}  // namespace sunder::gpu
