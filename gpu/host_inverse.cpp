// SPDX-License-Identifier: Apache-2.0
#include "gpu/host_inverse.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "body/stiffness_factor.hpp"

namespace sunder::gpu {
namespace {

// Up to this many unknowns the host keeps the dense inverse as well (288 MB): a fracture then
// copies its columns instead of solving for them.
constexpr Index kHostDense = 6000;

}  // namespace

HostInverse::HostInverse(const Problem& problem, bool keep_dense)
    : HostInverse(fem::factor_stiffness(problem), keep_dense) {}

HostInverse::HostInverse(const fem::DamagedBody& body, bool keep_dense,
                         const linear_algebra::FactorWork& work)
    : HostInverse(fem::factor_stiffness(body, work), keep_dense) {}

HostInverse::HostInverse(linear_algebra::Factor factor, bool keep_dense)
    : factor_(std::move(factor)) {
  if (keep_dense && factor_.cholesky().size() <= kHostDense) dense_ = factor_.inverse();
}

Eigen::MatrixXd HostInverse::columns(std::span<const Index> dofs) const {
  if (dense_.size() == 0) return factor_.inverse_columns(dofs);
  const std::vector<Index> list(dofs.begin(), dofs.end());
  return dense_(Eigen::all, list);
}

Eigen::MatrixXd HostInverse::range(Index first, Index count) const {
  if (dense_.size() > 0) return dense_.middleCols(first, count);
  std::vector<Index> list(static_cast<std::size_t>(count));
  std::iota(list.begin(), list.end(), first);
  return factor_.inverse_columns(list);
}

void HostInverse::differences(std::span<const solver::Difference> vectors,
                              Eigen::Ref<Eigen::MatrixXd> to) const {
  std::vector<Index> dofs;
  for (const solver::Difference& v : vectors) {
    dofs.push_back(v.dof);
    if (v.other != kNone) dofs.push_back(v.other);
  }
  std::sort(dofs.begin(), dofs.end());
  dofs.erase(std::unique(dofs.begin(), dofs.end()), dofs.end());
  Eigen::MatrixXd solved;
  if (!is_dense()) solved = factor_.inverse_columns(dofs);
  const auto column = [&](Index dof) {
    if (is_dense()) return dense_.col(dof);
    const auto at = std::lower_bound(dofs.begin(), dofs.end(), dof) - dofs.begin();
    return std::as_const(solved).col(at);
  };
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const auto [dof, other] = vectors[i];
    to.col(static_cast<Index>(i)) = column(dof);
    if (other != kNone) to.col(static_cast<Index>(i)) -= column(other);
  }
}

void upload_inverse(const HostInverse& host, DenseInverse& device) {
  device.upload([&](Index first, Index count) { return host.range(first, count); });
}

std::size_t HostInverse::bytes() const {
  return factor_.bytes() + static_cast<std::size_t>(dense_.size()) * sizeof(double);
}

}  // namespace sunder::gpu
