// SPDX-License-Identifier: Apache-2.0
// The body on the device: mesh, state of its elements, displacement, stress, f - K u. Every route
// writes a displacement; the rest is the same for all.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gpu/kernels.hpp"
#include "gpu/passes/block_matrix.hpp"
#include "gpu/passes/gather.hpp"
#include "gpu/passes/host_balance.hpp"
#include "gpu/passes/patch_pressures.hpp"
#include "gpu/passes/read_along.hpp"
#include "gpu/passes/summary.hpp"
#include "gpu/vulkan/commands.hpp"
#include "shaders/layout.h"
#include "sunder/backend.hpp"

namespace sunder::gpu {

/// Displacements that the device holds, in nodal layout (four values a node).
enum class Field { displacement, correction };

class Fields {
 public:
  /// What the route over these fields needs.
  struct RouteNeeds {
    std::size_t bytes = 0;        ///< of its own buffers, at most
    bool preconditioner = false;  ///< of the stiffness
    bool residual = true;         ///< f - K u, and the stiffness for it
    bool along = false;           ///< room for read_along()
  };
  /// Throws DeviceError, before anything is allocated, when the device's memory cannot hold the
  /// fields and the route's buffers together.
  Fields(const KernelFactory& kernels, const Problem& problem, const Needs& needs,
         const RouteNeeds& route);
  Fields(const KernelFactory& kernels, const Problem& problem, const Needs& needs)
      : Fields(kernels, problem, needs, RouteNeeds{}) {}

  /// Device bytes of the fields, before they exist.
  [[nodiscard]] std::size_t planned_bytes(bool preconditioner) const;

  /// Rows of a vector over the unknowns, padded.
  [[nodiscard]] std::uint32_t rows() const { return rows_; }
  [[nodiscard]] std::uint32_t packs() const { return rows_ / 4; }

  /// Whether the device computes stress. Not where nobody asks for it and nothing can break: its
  /// norm is then wanted for checks alone, of which each kind of load has one.
  [[nodiscard]] bool norms() const { return norms_; }

  void set_load(std::span<const double> force, std::span<const double> displacements);
  /// These unknowns are gripped from now on, those of the problem at first: what was recorded by
  /// others is to be recorded anew.
  void grip(std::span<const Index> gripped, std::span<const double> scale);
  /// Follows an event; `scale`: a_e after it (fem::DamagedBody::scale()), which stays where it is;
  /// `now`: as BlockMatrix::destroy() has it.
  void destroy(std::span<const Index> elements, std::span<const double> scale,
               const fem::Pools* now = nullptr);
  void exclude(std::span<const Index> elements);
  /// Their deformation no longer counts, from the next record_state() on.
  void cut_off(std::span<const Index> elements);

  /// The next record_keep() sets the displacement aside, for restore() when the solve fails.
  void keep_next() { keep_ = true; }
  [[nodiscard]] bool keeps_next() const { return keep_; }
  /// What the host reads of the states from the next one on: it comes along with them, where there
  /// is room.
  void read_along(ReadAlong::What what) { along_.ask(what); }
  [[nodiscard]] ReadAlong::What reads_along() const { return along_.asked(); }
  /// A state that was recorded as keeps_next() and reads_along() have it is submitted once more.
  void submitted_again() {
    keep_ = false;
    along_.again();
  }
  void record_keep(vulkan::Commands& commands);
  /// The displacement that was set aside, with its state.
  void restore();
  /// The field at gripped dofs as prescribed (displacement), or 0 (correction).
  void record_hold(vulkan::Commands& commands, Field field) const;
  /// Stress of the displacement and its summary; with `balance`, or without norms(), f - K u with r
  /// (0 at grips) too.
  void record_state(vulkan::Commands& commands, bool balance = true);
  /// Largest stress of the correction.
  void record_correction(vulkan::Commands& commands) const;

  /// f - K u, which record_state() leaves to the host where the device has no fp64.
  void balance_on_host();
  [[nodiscard]] const HostBalance& host_balance() const { return *host_balance_; }

  /// After record_state() and record_correction() ran. Without norms() there is no stress in it.
  [[nodiscard]] shaders::Summary state() const;
  /// Of the displacement; zeros without norms().
  [[nodiscard]] Deformation deformation() const;
  /// Stress and summary of the displacement anew.
  void renew_state();
  /// Largest stress of a live element, Frobenius; without norms() the host computes it.
  [[nodiscard]] double largest_stress(Field field) const;
  /// Bound of what rounding on the way out costs the stress of a live element, Frobenius [MPa]:
  /// stress in the precision it is stored in; displacement and stress in fp32 where they are shown
  /// so. After record_state() ran; 0 without norms().
  [[nodiscard]] double handed_out() const;
  /// A host shows displacement and stress in fp32.
  void show() { shown_ = true; }
  /// Whether the solution is made of numbers.
  [[nodiscard]] bool finite() const;
  /// Live breakable elements at or over yield, ascending.
  [[nodiscard]] std::vector<Index> over_yield() const;

  [[nodiscard]] const vulkan::Buffer& nodal(Field field) const {
    return field == Field::displacement ? displacement_ : correction_;
  }
  [[nodiscard]] vulkan::Buffer& nodal(Field field) {
    return field == Field::displacement ? displacement_ : correction_;
  }
  /// Two texels an element (shaders/stress.glsl); 16 bytes where stress was left out.
  [[nodiscard]] const vulkan::Buffer& stress() const { return stress_; }
  [[nodiscard]] const vulkan::Buffer& facts() const { return facts_; }
  /// The damaged stiffness.
  [[nodiscard]] const BlockMatrix& matrix() const { return matrix_; }
  [[nodiscard]] const vulkan::Buffer& positions() const { return positions_; }
  [[nodiscard]] const vulkan::Buffer& residual() const { return residual_; }
  /// Of each node: unknowns along x, y, z (kHeld: a support), gripped axes as bits.
  [[nodiscard]] const vulkan::Buffer& dofs() const { return dofs_; }

  /// f - K u at all unknowns, 0 at grips.
  void read_residual(std::span<double> residual) const;

  /// For tests of single kernels: inputs as given, shapes (3 * nodes) and (rows()).
  void write_displacement(std::span<const double> nodal);
  void write_residual(std::span<const double> residual);
  /// A field at all unknowns; supports stay at 0.
  void write_unknowns(Field field, const Eigen::VectorXd& values);

  /// A field at all nodes, shape (3 * nodes).
  void read(Field field, std::span<double> nodal) const;
  void read_displacement(std::span<double> nodal) const { read(Field::displacement, nodal); }
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
  void split_pools(const fem::Pools& now);
  void set_state_bits(std::span<const Index> elements, std::uint32_t bits);
  void create_kernels();
  void create_residual_pass();
  void create_hold();
  void upload_dofs();
  void record_stress(vulkan::Commands& commands, Field field, std::uint32_t keep) const;
  [[nodiscard]] shaders::ElementPush element_push(std::uint32_t keep) const;
  [[nodiscard]] shaders::Summary summary(std::size_t slot) const;
  [[nodiscard]] SummaryParts most_parts() const {
    return {norms_ ? element_parts_ : 1, node_parts_};
  }
  void read_wide(const vulkan::Buffer& buffer, std::span<double> values,
                 std::size_t first = 0) const;

  const KernelFactory& kernels_;
  const Problem& problem_;
  bool keep_stress_, list_over_, norms_, shown_ = false;
  bool has_residual_, has_along_;
  std::uint32_t rows_, elements_, nodes_;          // padded
  std::uint32_t element_parts_, node_parts_;       // partial results
  std::vector<shaders::ElementFacts> facts_host_;  // copy of facts_
  std::vector<std::uint32_t> place_;               // host copy of positions_
  std::vector<Index> gripped_;

  vulkan::Buffer nodes_of_, shape_, facts_;
  vulkan::Buffer dofs_, positions_;
  BlockMatrix matrix_;
  std::unique_ptr<HostBalance> host_balance_;  // empty: the device does it
  bool keep_ = false;
  vulkan::Buffer displacement_, kept_, correction_, load_, residual_, balance_;
  ReadAlong along_;
  vulkan::Buffer stress_, stress_partials_, node_partials_, summaries_, over_;

  struct Pass {
    std::unique_ptr<vulkan::Kernel> kernel;
    std::unique_ptr<vulkan::Binding> binding;
  };
  std::unique_ptr<PatchPressures> pools_;  // empty: nothing pools
  Pass stress_pass_, residual_pass_, hold_pass_;
  Pass patch_sums_;  // before the residual of a body that pools
  std::unique_ptr<SummaryPass> summary_pass_;
  vulkan::Buffer held_, prescribed_;  // gripped dofs
  std::unique_ptr<vulkan::Binding> correction_hold_;
  std::unique_ptr<vulkan::Binding> correction_stress_;
  std::unique_ptr<Gather> displacement_gather_, balance_gather_;
};

}  // namespace sunder::gpu
