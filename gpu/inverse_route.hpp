// SPDX-License-Identifier: Apache-2.0
// Route inverse: a dense inverse on the device, with the damage either as a correction to it
// (deferred) or worked into it (eager).
#pragma once

#include <future>
#include <memory>

#include "gpu/correction.hpp"
#include "gpu/host_inverse.hpp"
#include "gpu/passes/add.hpp"
#include "gpu/passes/exact_columns.hpp"
#include "gpu/route.hpp"

namespace sunder::gpu {

struct InverseOptions {
  bool eager = false;
  std::size_t panel_bytes = 0;  ///< largest buffer wanted, 0: the device's limit
  bool on_device = false;       ///< the inverse is computed there
};

class InverseRoute final : public DeviceRoute {
 public:
  InverseRoute(const KernelFactory& kernels, const Problem& problem, Fields& fields,
               std::shared_ptr<const HostInverse> intact, const InverseOptions& options);

  /// Device bytes that the route begins with, before they exist.
  [[nodiscard]] static std::size_t planned_bytes(const KernelFactory& kernels,
                                                 const Problem& problem,
                                                 const InverseOptions& options);

  int solve(const Load& load, bool balance) override;
  std::optional<EnergyBound> energy_bound() const override;
  int bases() const override { return bases_; }
  int correct() override;
  void add_correction() override;
  void destroy(std::span<const Index> elements, std::span<const Index> destroyed) override;
  bool restart(std::span<const Index> destroyed) override;

  const Eigen::MatrixXd* grip_factor() const override {
    return eager_ ? &grips_.matrixLLT() : &correction_->grip_factor();
  }
  std::string name() const override { return "inverse"; }
  std::string update() const override { return eager_ ? "eager" : "deferred"; }
  std::vector<BufferPlan> buffers() const override;
  std::vector<vulkan::PassTime> pass_times() const override;

 private:
  void make_base(std::span<const Index> destroyed);
  [[nodiscard]] std::vector<double> scale_of(std::span<const Index> destroyed) const;
  void bind();
  void make_exact();
  void extend_exact();
  void record_solution(Field field, std::uint32_t chunks, bool add);
  void record_state(bool balance);
  void solve_deferred(const Load& load, bool balance);
  void solve_on_exact(bool balance);
  void solve_eager(const Load& load, bool balance);
  bool update_eager(std::span<const Index> elements);
  void factor_grips();
  [[nodiscard]] Loaded grip_forces(Field field, std::span<const double> displacement) const;
  void defer(std::span<const Index> destroyed);
  void rebase(std::span<const Index> destroyed);
  void start_next_base(std::span<const Index> destroyed);
  bool take_next_base(std::span<const Index> destroyed);
  void correct_on_host();
  void ensure_base();

  const KernelFactory& kernels_;
  const Problem& problem_;
  Fields& fields_;
  std::shared_ptr<const HostInverse> host_;  // of the base
  InverseOptions options_;
  bool eager_, rebased_ = false;
  int bases_ = 0;
  std::vector<Index> base_destroyed_;  // elements that the base lacks
  bool base_stale_ = false;            // base_ is that of an earlier one
  DenseInverse base_;
  // A base to come, computed on a thread of its own while frames go on: started where the exact
  // columns pass a threshold and taken a fixed number of events later, so that results depend on
  // the events alone.
  std::future<std::shared_ptr<const HostInverse>> next_;
  std::vector<Index> next_destroyed_;
  int events_until_next_ = 0;
  bool next_possible_ = true;  // the host holds dense inverses, and they were positive definite
  ExactColumns exact_;
  std::unique_ptr<Correction> correction_;
  PartialSums partials_;
  std::unique_ptr<vulkan::Binding> sum_displacement_, sum_correction_;
  AddCorrection add_;
  Eigen::LLT<Eigen::MatrixXd> grips_;  // eager: X_GG
  vulkan::Commands commands_;
  /// A frame whose loads lie on exact columns: recorded once, submitted until its shape changes.
  struct Recorded {
    explicit Recorded(vulkan::Device& device) : commands(device) {}
    vulkan::Commands commands;
    Index columns = kNone;  // of the recording; kNone: none
    bool keep = false, timed = false;
  };
  Recorded quiet_, checked_;
  vulkan::Commands* last_ = &commands_;  // what pass_times() asks
};

}  // namespace sunder::gpu
