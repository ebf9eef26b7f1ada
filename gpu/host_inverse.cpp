// SPDX-License-Identifier: Apache-2.0
#include "gpu/host_inverse.hpp"

#include <cmath>
#include <numeric>
#include <vector>

namespace sunder::gpu {
namespace {

// Up to this many unknowns the host keeps the dense inverse as well (288 MB): a fracture then
// copies its columns instead of solving for them.
constexpr Index kHostDense = 6000;

}  // namespace

HostInverse::HostInverse(const Problem& problem, std::span<const double> scale, bool keep_dense)
    : factor_(problem, scale) {
  if (keep_dense && problem.dof_count() <= kHostDense) dense_ = factor_.inverse();
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

std::vector<double> upload_inverse(const HostInverse& host, DenseInverse& device, Index n) {
  std::vector<double> roots(static_cast<std::size_t>(n));
  device.upload([&](Index first, Index count) {
    Eigen::MatrixXd columns = host.range(first, count);
    for (Index c = 0; c < count; ++c) {
      roots[static_cast<std::size_t>(first + c)] = std::sqrt(columns(first + c, c));
    }
    return columns;
  });
  return roots;
}

std::vector<double> HostInverse::roots() const {
  const Eigen::VectorXd roots = dense_.diagonal().cwiseSqrt();
  return {roots.begin(), roots.end()};
}

std::size_t HostInverse::bytes() const {
  return factor_.bytes() + static_cast<std::size_t>(dense_.size()) * sizeof(double);
}

}  // namespace sunder::gpu
