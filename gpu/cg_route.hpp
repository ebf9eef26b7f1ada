// SPDX-License-Identifier: Apache-2.0
// Route cg: conjugate gradients wholly on the device. Scalars and the decision to stop stay there;
// a converged run zeroes the size of the dispatches that were recorded beyond it.
#pragma once

#include "gpu/passes/add.hpp"
#include "gpu/passes/block_matrix.hpp"
#include "gpu/passes/rigid_space.hpp"
#include "gpu/route.hpp"

namespace sunder::gpu {

class CgRoute final : public DeviceRoute {
 public:
  /// The body must outlive it.
  CgRoute(const KernelFactory& kernels, const fem::DamagedBody& body, Fields& fields);

  /// Device bytes of the route, before they exist.
  [[nodiscard]] static std::size_t planned_bytes(const KernelFactory& kernels,
                                                 const Problem& problem);

  int solve(const Load& load, double energy_tolerance, bool balance) override;
  int correct() override;
  void add_correction() override;
  void destroy(std::span<const Index> elements) override {
    rigid_.destroy(elements);  // Fields' matrix follows by itself
  }
  void grip(const fem::Event&) override { rigid_.grip(body_.forms().gripped()); }

  std::vector<BufferPlan> buffers() const override;

  /// Sizes of the dispatches of an iteration, three words for each of kCgSizes kinds: the device
  /// sets them to zero where it is done.
  [[nodiscard]] const vulkan::Buffer& dispatch_sizes() const { return arguments_; }

 private:
  void create_kernels(const Fields& fields);
  /// correction = K^-1 r, to a share of the first r^T M r; with a guess, or of u's energy if that
  /// is more. Returns iterations.
  int run(double reduction, bool guess);
  [[nodiscard]] shaders::CgPush push(bool first) const;
  /// Of one sum, in packs of four.
  [[nodiscard]] std::uint32_t partials() const;
  void record_start(double reduction, bool guess);
  void record_iterations();
  void refresh_state(bool add);

  const KernelFactory& kernels_;
  const fem::DamagedBody& body_;
  Fields& fields_;
  const BlockMatrix& matrix_;
  RigidSpace rigid_;
  AddCorrection add_;
  vulkan::Buffer r_, p_, q_, z_, pq_, rz_, state_, arguments_;
  struct Pass {
    std::unique_ptr<vulkan::Kernel> kernel;
    std::unique_ptr<vulkan::Binding> binding;
  };
  Pass begin_, multiply_, length_, step_, check_, direction_;
  vulkan::Commands commands_;
};

}  // namespace sunder::gpu
