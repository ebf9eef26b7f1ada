// SPDX-License-Identifier: Apache-2.0
// Route inverse on a device without shaderFloat64: the device holds the base in fp32 and does
// u = X f, stress and its summary; the host has the exact columns, the small matrix and f - K u in
// fp64. Displacements are two floats a number, so that neither hand-over costs digits.
#pragma once

#include <memory>

#include "gpu/correction.hpp"
#include "gpu/host_inverse.hpp"
#include "gpu/passes/add.hpp"
#include "gpu/route.hpp"

namespace sunder::gpu {

class HostCorrectedRoute final : public DeviceRoute {
 public:
  HostCorrectedRoute(const KernelFactory& kernels, const Problem& problem, Fields& fields,
                     std::shared_ptr<const HostInverse> intact, std::size_t panel_bytes);

  /// Device bytes of the route, before they exist.
  [[nodiscard]] static std::size_t planned_bytes(const KernelFactory& kernels,
                                                 const Problem& problem, std::size_t panel_bytes);

  int solve(const Load& load, bool balance) override;
  std::optional<EnergyBound> energy_bound() const override;
  int bases() const override { return bases_; }
  int correct() override;
  void add_correction() override;
  void destroy(std::span<const Index> elements, std::span<const Index> destroyed) override;
  bool restart(std::span<const Index> destroyed) override;

  const Eigen::MatrixXd* grip_factor() const override { return &correction_->grip_factor(); }
  std::string name() const override { return "inverse"; }
  std::string update() const override { return "deferred"; }
  std::vector<BufferPlan> buffers() const override;
  std::vector<vulkan::PassTime> pass_times() const override { return commands_.pass_times(); }

 private:
  void make_base();
  void write_corrected(Field field, const Eigen::VectorXd& coefficients);
  void record_sum(Field field, std::uint32_t chunks);

  const Problem& problem_;
  Fields& fields_;
  std::shared_ptr<const HostInverse> host_;  // of the base
  DenseInverse base_;
  PartialSums partials_;
  std::unique_ptr<Correction> correction_;
  std::unique_ptr<vulkan::Binding> sum_displacement_, sum_correction_;
  AddCorrection add_;
  vulkan::Commands commands_;
  int bases_ = 0;
};

}  // namespace sunder::gpu
