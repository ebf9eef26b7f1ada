// SPDX-License-Identifier: Apache-2.0
// The body on the device: mesh, state of its elements, displacement, stress, f - K u. Every route
// writes a displacement; the rest is the same for all.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gpu/kernels.hpp"
#include "gpu/passes/gather.hpp"
#include "gpu/vulkan/commands.hpp"
#include "shaders/layout.h"
#include "sunder/backend.hpp"

namespace sunder::gpu {

[[nodiscard]] constexpr std::uint32_t round_up(std::uint32_t value, std::uint32_t to) {
  return (value + to - 1) / to * to;
}

/// Displacements that the device holds, in nodal layout (four values a node).
enum class Field { displacement, correction };

class Fields {
 public:
  Fields(const KernelFactory& kernels, const Problem& problem, const Needs& needs);

  /// Rows of a vector over the unknowns, padded.
  [[nodiscard]] std::uint32_t rows() const { return rows_; }
  [[nodiscard]] std::uint32_t packs() const { return rows_ / 4; }

  void set_load(std::span<const double> force, std::span<const double> displacements);
  void destroy(std::span<const Index> elements);
  void exclude(std::span<const Index> elements);

  /// The next record_keep() sets the displacement aside, for restore() when the solve fails.
  void keep_next() { keep_ = true; }
  void record_keep(vulkan::Commands& commands);
  /// The displacement that was set aside, with its state.
  void restore();
  /// The field at gripped dofs as prescribed (displacement), or 0 (correction).
  void record_hold(vulkan::Commands& commands, Field field) const;
  /// Stress of the displacement, its summary, and f - K u with r (0 at grips).
  void record_state(vulkan::Commands& commands) const;
  /// Largest stress of the correction.
  void record_correction(vulkan::Commands& commands) const;

  /// After record_state() and record_correction() ran.
  [[nodiscard]] shaders::Summary state() const { return summaries_.mapped<shaders::Summary>()[0]; }
  [[nodiscard]] shaders::Summary correction() const {
    return summaries_.mapped<shaders::Summary>()[1];
  }

  [[nodiscard]] const vulkan::Buffer& nodal(Field field) const {
    return field == Field::displacement ? displacement_ : correction_;
  }
  [[nodiscard]] vulkan::Buffer& nodal(Field field) {
    return field == Field::displacement ? displacement_ : correction_;
  }
  [[nodiscard]] const vulkan::Buffer& positions() const { return positions_; }
  [[nodiscard]] const vulkan::Buffer& residual() const { return residual_; }
  /// Of each node: unknowns along x, y, z (kHeld: a support), gripped axes as bits.
  [[nodiscard]] const vulkan::Buffer& dofs() const { return dofs_; }

  /// For tests of single kernels: inputs as given, shapes (3 * nodes) and (rows()).
  void write_displacement(std::span<const double> nodal);
  void write_residual(std::span<const double> residual) { residual_.write(residual); }

  void read_displacement(std::span<double> nodal) const;
  [[nodiscard]] Vec3 read_displacement(Index node) const;
  /// At some nodes; only they cross to the host.
  void read_displacement(std::span<const Index> nodes, std::span<Vec3> displacement) const;
  /// A field at some unknowns.
  [[nodiscard]] Eigen::VectorXd read_unknowns(Field field, std::span<const Index> dofs) const;
  void read_stress(std::span<Voigt> stress) const;
  [[nodiscard]] Voigt read_stress(Index element) const;
  /// Minus (f - K u) at some unknowns.
  void read_reactions(std::span<const Index> dofs, std::span<double> reactions) const;

  [[nodiscard]] std::vector<BufferPlan> buffers() const;

 private:
  void upload_mesh();
  void upload_shapes();
  void upload_corners();
  void set_state_bits(std::span<const Index> elements, std::uint32_t bits);
  void create_kernels();
  void create_hold();
  [[nodiscard]] shaders::ElementPush element_push(bool store) const;

  const KernelFactory& kernels_;
  const Problem& problem_;
  bool keep_stress_;
  std::uint32_t rows_, elements_, nodes_;  // padded
  std::vector<std::uint32_t> states_;      // host copy of state_
  std::vector<std::uint32_t> place_;       // host copy of positions_

  vulkan::Buffer nodes_of_, shape_, yield_, state_;
  vulkan::Buffer corner_start_, corners_, dofs_, positions_;
  bool keep_ = false;
  vulkan::Buffer displacement_, kept_, correction_, load_, residual_, balance_;
  vulkan::Buffer element_force_, stress_, stress_partials_, node_partials_, summaries_;

  struct Pass {
    std::unique_ptr<vulkan::Kernel> kernel;
    std::unique_ptr<vulkan::Binding> binding;
  };
  Pass stress_pass_, force_pass_, residual_pass_, summary_pass_, hold_pass_;
  vulkan::Buffer held_, prescribed_;  // gripped dofs
  std::unique_ptr<vulkan::Binding> correction_hold_;
  std::unique_ptr<vulkan::Binding> correction_stress_;
  std::unique_ptr<Gather> displacement_gather_, balance_gather_;
};

}  // namespace sunder::gpu
