// SPDX-License-Identifier: Apache-2.0
// Route inverse on a device without shaderFloat64: the device holds the base in fp32 and does
// u = X f, stress and its summary; the host has the exact columns, the small matrix and f - K u in
// fp64. Displacements are two floats a number, so that neither hand-over costs digits.
#pragma once

#include <memory>

#include "gpu/host_update.hpp"
#include "gpu/passes/add.hpp"
#include "gpu/route.hpp"

namespace sunder::gpu {

class HostCorrectedRoute final : public DeviceRoute {
 public:
  /// The body must outlive it. `damage`: something can be destroyed.
  HostCorrectedRoute(const KernelFactory& kernels, const fem::DamagedBody& body, Fields& fields,
                     std::shared_ptr<const HostInverse> intact, std::size_t panel_bytes,
                     bool damage);

  /// Device bytes of the route, before they exist.
  [[nodiscard]] static std::size_t planned_bytes(const KernelFactory& kernels,
                                                 const Problem& problem, std::size_t panel_bytes);

  int solve(const Load& load, double energy_tolerance, bool balance) override;
  int correct(bool add) override;
  bool corrects_on_host() const override { return true; }
  void add_correction() override;
  void destroy(std::span<const Index> elements) override;
  void grip(const fem::Event& event) override;
  bool rebase() override;

  const solver::RenewedUpdate* update() const override { return update_.get(); }
  std::vector<BufferPlan> buffers() const override;
  std::size_t host_solves() const override { return supernodes_->solved.get(); }

 private:
  void follow_update();
  void ensure_base();
  [[nodiscard]] const Eigen::MatrixXd& load_columns(std::span<const Index> dofs);
  void write_exact(const Load& load, const Eigen::VectorXd& of_damage, bool loads);
  void record_addition();

  const Problem& problem_;
  Fields& fields_;
  std::shared_ptr<const linear_algebra::Supernodes> supernodes_;  // of all factors of the body
  std::unique_ptr<solver::RenewedUpdate> update_;
  int bases_ = 1;            // of update_
  bool base_stale_ = false;  // base_ is that of an earlier one
  DenseInverse base_;
  PartialSums partials_;
  std::unique_ptr<vulkan::Binding> sum_displacement_;
  AddCorrection add_;
  vulkan::Commands commands_;
  std::vector<Index> all_, loaded_;  // every unknown; those whose columns are in load_columns_
  Eigen::MatrixXd load_columns_;
  Eigen::VectorXd exact_, correction_;
};

}  // namespace sunder::gpu
