// SPDX-License-Identifier: Apache-2.0
// A body at finite deformation on the device: internal forces, stress and residual of its states,
// and the steps between them (core/solver/finite_steps.hpp), of L-BFGS on a dense inverse or of
// Newton by conjugate gradients. One submit an iteration, and one more for each shorter step of the
// line search; fp64 but for the inverse or the tangents, which may be stored in fp32.
#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "gpu/finite_cg.hpp"
#include "gpu/kernels.hpp"
#include "gpu/vulkan/commands.hpp"
#include "solver/finite_potential.hpp"

namespace sunder::gpu {

class FiniteDevice final : public solver::FiniteDevice {
 public:
  struct Options {
    Route route = Route::inverse;  ///< or cg; or factor: the host steps, states are the device's
    StressMeasure stress = StressMeasure::cauchy;
    int pairs = 5;  ///< of L-BFGS
    bool viscous = false;
    std::uint32_t shares = 0;  ///< of the sums, summed by a workgroup each; 0: by the body's size
  };
  /// `body` names problem and laws, which must outlive it, as must the kernels and their device;
  /// `keeps`: what owns these, kept until the end. Throws DeviceError where the device's memory or
  /// buffers do not do.
  FiniteDevice(const KernelFactory& kernels, const fem::HyperelasticBody& body,
               const Options& options, std::shared_ptr<void> keeps = {});

  void attach(const solver::RestingBody& body) override;
  void evaluate(const solver::FiniteTarget& target, bool with_stress,
                solver::FiniteState& state) override;
  [[nodiscard]] Needs needs() const override;
  solver::FinitePoint begin(const solver::FiniteTarget& target, solver::FiniteBase* base,
                            solver::FiniteState& state) override;
  solver::FiniteTrial whole(bool with_stress) override;
  solver::FiniteTrial part(double of, bool with_stress) override;
  void take() override;
  void end() override;

  /// Stress at a displacement (3 * nodes), of elements that count.
  void stress(std::span<const double> u, std::span<Voigt> stress) override;
  [[nodiscard]] std::size_t inner_iterations() const override { return inner_iterations_; }
  [[nodiscard]] std::vector<BufferPlan> buffers() const override;
  [[nodiscard]] std::vector<KernelPlan> kernels() const override {
    return describe(device_.living_pipelines());
  }
  /// Bytes of the inverse for so many unknowns.
  [[nodiscard]] static std::size_t inverse_bytes(const KernelFactory& kernels,
                                                 const Problem& problem);
  /// The most unknowns whose inverse a buffer holds.
  [[nodiscard]] static Index most_inverse(const KernelFactory& kernels);
  /// Of all but states and mesh: what the route takes.
  [[nodiscard]] static std::size_t route_bytes(const KernelFactory& kernels, Route route,
                                               const Problem& problem);
  /// What a device can bind of it at once.
  [[nodiscard]] static std::size_t largest_buffer(const KernelFactory& kernels);

 private:
  struct Pass {
    std::unique_ptr<vulkan::Kernel> kernel;
    std::array<std::unique_ptr<vulkan::Binding>, 2> binding;  // by which state is the first
  };
  using Buffers = std::vector<const vulkan::Buffer*>;
  void make(Pass& pass, std::string_view name, bool real, const Buffers& first,
            const Buffers& second);
  void create_buffers(bool viscous);
  void create_passes();
  void create_patches(const fem::HyperelasticBody& body);
  void create_law();
  void create_inverse();
  void create_cg(const fem::HyperelasticBody& body);
  void bind_base();
  void make_rank_room(std::uint32_t rank);
  void set_target(const solver::FiniteTarget& target);
  void set_base(const solver::FiniteBase& base);
  void set_inverse(const Eigen::MatrixXd& inverse);
  void set_state(std::span<const double> u);
  void over(const Pass& pass, const shaders::FinitePush& push, std::uint32_t count,
            std::uint32_t rows = 1);
  void record_direction();
  void record_evaluation(const shaders::FinitePush& push, bool next);
  [[nodiscard]] shaders::FinitePush push() const;
  [[nodiscard]] solver::FinitePoint point() const;
  [[nodiscard]] solver::FiniteTrial trial(double part, bool direction);
  void read(solver::FiniteState& state, bool with_displacement, bool with_stress);

  std::shared_ptr<void> keeps_;  // first: it goes last
  const KernelFactory& kernels_;
  vulkan::Device& device_;
  const Problem& problem_;
  Options options_;
  std::uint32_t elements_, nodes_, entries_, unknowns_, patches_, rows_, pairs_, shares_;
  const solver::RestingBody* resting_ = nullptr;

  // Of both states: displacement, residual, forces, stress.
  std::array<vulkan::Buffer, 2> u_, r_, f_, stress_;
  vulkan::Buffer nodes_of_, shape_, fibres_, facts_, first_, around_, entries_of_, held_, from_,
      target_;
  vulkan::Buffer patch_first_, patch_elements_, pressures_;  // where volume is pooled
  std::shared_ptr<const fem::Pools> split_;                  // as they have it
  vulkan::Buffer corners_, viscous_corners_, element_partials_, entry_partials_, sums_,
      shares_of_sums_;  // the latter where there are several
  vulkan::Buffer du_, q_, x_, partial_, s_, y_, products_, lengths_;
  vulkan::Buffer inverse_, touched_, small_, coefficients_, turned_, rotations_;
  Pass move_, pools_, law_, gather_, sum_, join_, begin_, turn_q_, turn_x_, product_, fold_,
      small_pass_, columns_, end_;
  std::unique_ptr<FiniteCg> cg_;  // route cg
  std::size_t inner_iterations_ = 0;
  vulkan::Commands commands_;

  std::size_t first_state_ = 0;  // of the two
  std::vector<double> known_;    // displacement of the first state, where it is evaluated there
  std::vector<double> shown_target_;  // as target_ has it
  const fem::Viscosity* viscosity_ = nullptr;
  std::uint64_t viscous_start_ = 0;
  double viscous_ = 0;
  bool inertia_ = false;
  double loaded_squared_ = 0;
  solver::FiniteBase::Stamps stamps_{0, 0, 0};
  std::uint32_t rank_ = 0, turned_count_ = 0, rank_room_ = 0;
  std::vector<std::uint32_t> order_;  // slots of the pairs, the oldest first
  std::uint32_t slot_ = 0;            // of the trial
  solver::FiniteState* state_ = nullptr;
};

}  // namespace sunder::gpu
