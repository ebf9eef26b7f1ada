// SPDX-License-Identifier: Apache-2.0
// Route cg: conjugate gradients wholly on the device. Scalars and the decision to stop stay there;
// a converged run zeroes the size of the dispatches that were recorded beyond it.
#pragma once

#include <optional>

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
  int correct(bool add) override;
  void add_correction() override;
  void destroy(std::span<const Index> elements) override {
    rigid_.destroy(elements);  // Fields' matrix follows by itself
    forget_known();
  }
  void grip(const fem::Event&) override {
    rigid_.grip(body_.forms().gripped());
    forget_known();
  }

  std::vector<BufferPlan> buffers() const override;
  bool iterates() const override { return true; }
  void add_to(solver::FrameShape& shape) const override {
    shape.groups = RigidSpace::planned_groups(body_.problem());
  }

  /// Sizes of the dispatches of an iteration, three words for each of kCgSizes kinds: the device
  /// sets them to zero where it is done.
  [[nodiscard]] const vulkan::Buffer& dispatch_sizes() const { return arguments_; }

 private:
  void create_kernels(const Fields& fields);
  /// correction = K^-1 r, to a share of the first r^T M r; of a solution, or of its energy if that
  /// is more: then what is known of it goes to the displacement first. Returns iterations.
  int run(double reduction, bool solution);
  /// Its first submit.
  void start(double reduction, bool solution);
  [[nodiscard]] shaders::CgPush push(bool first) const;
  /// Of one sum, in packs of four.
  [[nodiscard]] std::uint32_t partials() const;
  /// Bytes of a solution that is known.
  [[nodiscard]] std::size_t slot_bytes() const { return known_.bytes() / most_known_; }
  void record_start(double reduction, bool solution);
  /// Where they are not as they were: of the body only the levels' buffers ever move.
  void record_iterations();
  void record_state(vulkan::Commands& commands) const;
  /// The displacement where nothing but grips has moved; of bodies of which nothing is known the
  /// last one takes the place of that.
  void record_begin();
  void forget_known() {
    known_count_ = 0;
    quiet_ = false;
  }
  /// displacement += correction, with its state.
  void finish(bool keep_known);

  const KernelFactory& kernels_;
  const fem::DamagedBody& body_;
  Fields& fields_;
  const BlockMatrix& matrix_;
  RigidSpace rigid_;
  AddCorrection add_;
  vulkan::Buffer r_, p_, q_, z_, pq_, rz_, state_, arguments_;
  vulkan::Buffer found_;  // what the host reads of state_
  // Solutions of this body, each of a load's share that those before it left over: K keeps them
  // apart, so that a load that is a sum of former ones takes a step along each and no iteration.
  vulkan::Buffer known_;
  std::uint32_t most_known_, known_count_ = 0, next_known_ = 0;
  bool quiet_ = false;  // the last solution took no iteration: nor will the next, most likely
  struct Pass {
    std::unique_ptr<vulkan::Kernel> kernel;
    std::unique_ptr<vulkan::Binding> binding;
  };
  Pass patch_sums_;  // before multiply_, of a body that pools
  Pass begin_, known_step_, multiply_, length_, step_, check_, direction_;
  vulkan::Commands commands_, iterations_;
  // What iterations_ was recorded with: its sizes, whether its passes are timed, and the levels as
  // they were bound then.
  std::optional<shaders::CgPush> recorded_;
  bool recorded_timed_ = false;
  int recorded_levels_ = 0;
};

}  // namespace sunder::gpu
