// SPDX-License-Identifier: Apache-2.0
// Route condensed's columns X_SS B on the device, which multiplies them in fp64: a product brings
// 64 at most, as far as there is room. The host has X_SS and multiplies what is not there.
#pragma once

#include <memory>
#include <vector>

#include "gpu/passes/exact_columns.hpp"
#include "solver/region_product.hpp"

namespace sunder::gpu {

class RegionColumns final : public solver::RegionProduct {
 public:
  /// For `unknowns` of the region; of fewer values than `least` nothing is taken.
  RegionColumns(const KernelFactory& kernels, Index unknowns, std::size_t least);

  /// Device bytes of that, before it exists.
  [[nodiscard]] static std::size_t planned_bytes(const vulkan::PhysicalDevice& device,
                                                 Index unknowns);
  /// Values of as many columns as there is room for.
  [[nodiscard]] static std::size_t most_values(const vulkan::PhysicalDevice& device,
                                               Index unknowns);
  [[nodiscard]] std::size_t bytes() const;

  void begin() override { columns_.clear(); }
  void forget(Index count) override { columns_.keep(count); }
  Index follow(const solver::CondensedBase& base) override;
  void add(const Eigen::VectorXd& c, Eigen::VectorXd& u) override;
  Index rows() const override { return unknowns_; }
  /// Whether a base of so many columns has its product here.
  [[nodiscard]] bool takes(Index columns) const {
    return columns > 0 &&
           static_cast<std::size_t>(columns) * static_cast<std::size_t>(unknowns_) >= least_;
  }

 private:
  Index unknowns_;
  std::size_t least_;
  std::uint32_t rows_, capacity_;
  ExactColumns columns_;
  PartialSums partials_;
  vulkan::Buffer positions_, product_, read_back_;
  std::unique_ptr<vulkan::Binding> sum_;
  Eigen::MatrixXd added_;
  vulkan::Commands commands_;
};

}  // namespace sunder::gpu
