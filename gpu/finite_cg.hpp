// SPDX-License-Identifier: Apache-2.0
// The direction of a Newton step by conjugate gradients on the exact tangent of a state, which is
// kept element by element: no matrix, no factor. Preconditioned by the nodes' 3 x 3 blocks and by
// rigid motions of groups of nodes (passes/rigid_space.hpp). They end at a share of the residual,
// at a direction of negative stiffness, or after as many iterations as are recorded: each leaves a
// direction along which the potential falls (Nocedal and Wright 2006, 7.1).
#pragma once

#include <memory>
#include <string_view>

#include "gpu/kernels.hpp"
#include "gpu/passes/rigid_space.hpp"
#include "gpu/vulkan/commands.hpp"
#include "solver/resting_body.hpp"

namespace sunder::gpu {

/// Buffers of a body's states that conjugate gradients read and write (gpu/finite_device.hpp).
struct FiniteCgBody {
  const vulkan::Buffer &nodes, &shape, &fibres, &facts, &from, &first, &around, &target;
  const vulkan::Buffer& corners;      ///< written
  const vulkan::Buffer& du;           ///< written: the direction, per unknown
  const vulkan::Buffer *u[2], *r[2];  ///< of both states
};

class FiniteCg {
 public:
  /// The kernels, their device, the problem and the buffers must outlive it.
  FiniteCg(const KernelFactory& kernels, const Problem& problem,
           std::span<const std::uint8_t> destroyed, const FiniteCgBody& body);

  /// Device bytes, before they exist.
  [[nodiscard]] static std::size_t planned_bytes(const KernelFactory& kernels,
                                                 const Problem& problem);
  /// What is held, frozen or destroyed has changed.
  void attach(const solver::RestingBody& body);
  /// Steps from u (3 * nodes) under such an inertia follow.
  void begin(std::span<const double> u, const fem::Inertia& inertia);
  /// The direction from one of the two states, by push of FiniteDevice.
  void record(vulkan::Commands& commands, const shaders::FinitePush& push, std::size_t state);
  /// After the submit: how many iterations are worth recording next.
  void learn();
  /// Of the last submit.
  [[nodiscard]] int iterations() const;

  [[nodiscard]] std::vector<BufferPlan> buffers() const;

 private:
  struct Pass {
    std::unique_ptr<vulkan::Kernel> kernel;
    std::unique_ptr<vulkan::Binding> binding;
  };
  using Buffers = std::initializer_list<const vulkan::Buffer*>;
  void make(Pass& pass, std::string_view name, bool real, std::uint32_t group, Buffers buffers);
  void create_passes(const FiniteCgBody& body);
  void record_multiply(vulkan::Commands& commands, bool indirect) const;
  [[nodiscard]] shaders::CgPush push(bool first) const;

  const KernelFactory& kernels_;
  const Problem& problem_;
  std::uint32_t elements_, nodes_, node_groups_, element_groups_, partials_;
  int recorded_;
  std::vector<std::uint8_t> out_;  // as rigid_ has it
  RigidSpace rigid_;
  vulkan::Buffer tangents_, inverses_, dofs_, x_, r_, p_, q_, z_, pq_, rz_, state_, arguments_;
  vulkan::Buffer read_;         // what the host reads of state_
  Pass tangent_[2], begin_[2];  // by state
  Pass blocks_, apply_, multiply_, length_, step_, check_, direction_, found_;
};

}  // namespace sunder::gpu
