// SPDX-License-Identifier: Apache-2.0
#include "gpu/host_inverse.hpp"

#include <numeric>
#include <vector>

#include "body/stiffness_factor.hpp"

namespace sunder::gpu {
namespace {

// Up to this many unknowns the host keeps the dense inverse as well (288 MB): a fracture then
// copies its columns instead of solving for them.
constexpr Index kHostDense = 6000;

}  // namespace

HostInverse::HostInverse(const Problem& problem, bool keep_dense)
    : HostInverse(std::make_shared<const linear_algebra::Factor>(
                      fem::factor_stiffness(problem, {}, linear_algebra::work_at_once())),
                  keep_dense, linear_algebra::work_at_once()) {}

HostInverse::HostInverse(std::shared_ptr<const linear_algebra::Factor> factor, bool keep_dense,
                         const linear_algebra::FactorWork& work)
    : factor_(std::move(factor)) {
  if (keep_dense && factor_->cholesky().size() <= kHostDense) dense_ = factor_->inverse(work);
}

Eigen::MatrixXd HostInverse::columns(std::span<const Index> dofs) const {
  if (dense_.size() == 0) return factor_->inverse_columns(dofs);
  const std::vector<Index> list(dofs.begin(), dofs.end());
  return dense_(Eigen::all, list);
}

Eigen::MatrixXd HostInverse::range(Index first, Index count) const {
  if (dense_.size() > 0) return dense_.middleCols(first, count);
  std::vector<Index> list(static_cast<std::size_t>(count));
  std::iota(list.begin(), list.end(), first);
  return factor_->inverse_columns(list, linear_algebra::work_at_once());
}

void upload_inverse(const HostInverse& host, DenseInverse& device) {
  device.upload([&](Index first, Index count) { return host.range(first, count); });
}

std::size_t HostInverse::bytes() const {
  return factor_->bytes() + static_cast<std::size_t>(dense_.size()) * sizeof(double);
}

}  // namespace sunder::gpu
