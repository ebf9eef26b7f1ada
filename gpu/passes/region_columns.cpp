// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/region_columns.hpp"

#include <numeric>

#include "gpu/passes/fields.hpp"
#include "solver/condensed_base.hpp"
#include "solver/condensed_route.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// Columns that a product brings to the device: of 10,000 unknowns 5 MB.
constexpr Index kAtOnce = 64;

std::uint32_t padded_rows(Index unknowns) {
  return round_up(static_cast<std::uint32_t>(unknowns), shaders::kRowPad);
}

/// Columns that there is room for: those that a base is expected to come to.
std::uint32_t capacity_of(const vulkan::PhysicalDevice& device, Index unknowns) {
  const auto wanted =
      static_cast<std::uint32_t>(solver::columns_of_a_base(static_cast<std::size_t>(unknowns)));
  return std::min(round_up(wanted, shaders::kChunk),
                  ExactColumns::most(device, padded_rows(unknowns)));
}

}  // namespace

RegionColumns::RegionColumns(const KernelFactory& kernels, Index unknowns, std::size_t least)
    : unknowns_(unknowns),
      least_(least),
      rows_(padded_rows(unknowns)),
      capacity_(capacity_of(kernels.device().physical(), unknowns)),
      columns_(kernels, rows_),
      partials_(kernels, rows_, capacity_ / shaders::kChunk),
      positions_(kernels.device(), rows_ * sizeof(std::uint32_t), Placement::device),
      product_(kernels.device(), rows_ * sizeof(double), Placement::device),
      read_back_(kernels.device(), rows_ * sizeof(double), Placement::host),
      commands_(kernels.device()) {
  std::vector<std::uint32_t> positions(rows_);
  std::iota(positions.begin(), positions.end(), 0u);
  positions_.write(std::span<const std::uint32_t>(positions));
  columns_.reserve(capacity_);
  columns_.bind(partials_);
  columns_.bind_solve(positions_, product_);
  sum_ = partials_.bind_sum(positions_, product_);
  added_.resize(unknowns_, kAtOnce);
}

std::size_t RegionColumns::planned_bytes(const vulkan::PhysicalDevice& device, Index unknowns) {
  const std::uint32_t rows = padded_rows(unknowns), capacity = capacity_of(device, unknowns);
  return ExactColumns::planned_bytes(rows, capacity) +
         std::size_t{capacity / shaders::kChunk} * rows * sizeof(double) +
         rows * (sizeof(std::uint32_t) + 2 * sizeof(double));
}

std::size_t RegionColumns::most_values(const vulkan::PhysicalDevice& device, Index unknowns) {
  return std::size_t{capacity_of(device, unknowns)} * static_cast<std::size_t>(unknowns);
}

std::size_t RegionColumns::bytes() const {
  return columns_.bytes() + partials_.buffer().bytes() + positions_.bytes() + product_.bytes() +
         read_back_.bytes();
}

Index RegionColumns::follow(const solver::CondensedBase& base) {
  if (!takes(base.count())) return 0;
  const Index before = columns_.count(),
              end = std::min({base.count(), before + kAtOnce, static_cast<Index>(capacity_)});
  if (end > before) {
    base.columns(before, added_.leftCols(end - before));
    columns_.append(added_.leftCols(end - before));
  }
  return columns_.count();
}

void RegionColumns::add(const Eigen::VectorXd& c, Eigen::VectorXd& u) {
  columns_.set_coefficients(c);
  commands_.begin();
  commands_.pass("solve");
  if (columns_.whole_in_one()) {
    columns_.record_solve(commands_);
  } else {
    partials_.record_sum(commands_, *sum_, columns_.record_apply(commands_, 0), false);
  }
  commands_.copy(product_.handle(), product_.offset(), read_back_.handle(), read_back_.offset(),
                 product_.bytes());
  commands_.end();
  commands_.submit();
  u.head(unknowns_) += Eigen::Map<const Eigen::VectorXd>(read_back_.mapped<double>(), unknowns_);
}

}  // namespace sunder::gpu
