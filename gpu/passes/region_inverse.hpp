// SPDX-License-Identifier: Apache-2.0
// Route condensed's X_SS on the device, which multiplies it in fp64 by the forces of damage. Where
// there is room for all of it the first base's comes before the frames, a later one's over them:
// columns that a frame needs first, as the host has X_SS too and multiplies what is not there.
// Where there is not, those alone that frames need.
#pragma once

#include <memory>
#include <vector>

#include "gpu/passes/dense_inverse.hpp"
#include "solver/region_product.hpp"

namespace sunder::gpu {

class RegionInverse final : public solver::RegionProduct {
 public:
  /// What is there: all of X_SS, or the columns that frames need.
  enum class Extent { whole, columns };

  /// For `unknowns` of the region; of fewer values than `least` nothing is multiplied.
  RegionInverse(const KernelFactory& kernels, Index unknowns, std::size_t panel_bytes,
                std::size_t least, Extent extent);

  /// Device bytes of that, before it exists.
  [[nodiscard]] static std::size_t planned_bytes(const KernelFactory& kernels, Index unknowns,
                                                 std::size_t panel_bytes, Extent extent);
  /// Values of as many columns as a product takes at most.
  [[nodiscard]] static std::size_t most_values(Index unknowns);
  [[nodiscard]] Extent extent() const { return extent_; }
  [[nodiscard]] std::size_t bytes() const;

  void begin(const solver::CondensedBase& base) override;
  void forget(Index unknowns) override;
  bool follow(const solver::CondensedBase& base, std::span<const Index> places) override;
  bool has(Index place) const override {
    const auto at = static_cast<std::size_t>(place);
    return at < slot_.size() && slot_[at] != kNone;
  }
  std::size_t most() const override { return most_; }
  void add(std::span<const Index> places, std::span<const double> values,
           Eigen::VectorXd& u) override;
  Index rows() const override { return unknowns_; }
  /// Whether a frame with damage at so many places has its product here.
  [[nodiscard]] bool takes(Index places) const {
    return places > 0 &&
           static_cast<std::size_t>(places) * static_cast<std::size_t>(unknowns_) >= least_;
  }
  /// Columns that are there.
  [[nodiscard]] Index count() const;

 private:
  [[nodiscard]] bool bring(const solver::CondensedBase& base, Index place);

  Index unknowns_;
  std::size_t least_, most_;
  Extent extent_;
  KernelFactory stored_;
  std::uint32_t rows_;
  DenseInverse inverse_;
  PartialSums partials_;
  vulkan::Buffer positions_, product_, read_back_;
  std::unique_ptr<vulkan::Binding> sum_;
  vulkan::Commands commands_;
  bool begun_ = false;
  std::vector<Index> slot_;  // where among the columns that of each place is; kNone: nowhere
  std::vector<Index> free_;  // that no place has, those to be taken last first
  Index ahead_ = 0;          // up to here all places have their own
  Loaded loaded_;
  std::vector<Index> order_;
};

}  // namespace sunder::gpu
