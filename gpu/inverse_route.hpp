// SPDX-License-Identifier: Apache-2.0
// Route inverse: a dense inverse on the device, with the damage either as a correction to it
// (deferred) or worked into it (eager). The small matrices are the host's, and the device's too
// where they are large.
#pragma once

#include <memory>
#include <optional>

#include "gpu/host_update.hpp"
#include "gpu/passes/add.hpp"
#include "gpu/passes/damage_solution.hpp"
#include "gpu/passes/exact_columns.hpp"
#include "gpu/passes/inverse_update.hpp"
#include "gpu/route.hpp"

namespace sunder::gpu {

struct InverseOptions {
  bool eager = false;
  std::size_t panel_bytes = 0;  ///< largest buffer wanted, 0: the device's limit
  bool on_device = false;       ///< the inverse is computed there
  bool fp64 = false;            ///< and stays in fp64, whatever the precision is
  /// Of route condensed: values of the region's columns from which on the device multiplies them;
  /// none: the host does.
  std::optional<std::size_t> region = {};
  /// Columns of the damage from which on the device solves with the small matrices, on either
  /// route; none: the host does.
  std::optional<Index> damage = {};
  /// Takes what there is no room for.
  LeaveOut leave_out = {};
};

class InverseRoute final : public DeviceRoute {
 public:
  /// The body must outlive it. `damage`: something can be destroyed.
  InverseRoute(const KernelFactory& kernels, const fem::DamagedBody& body, Fields& fields,
               std::shared_ptr<const HostInverse> intact, const InverseOptions& options,
               bool damage);

  /// Device bytes that the route begins with, before they exist.
  [[nodiscard]] static std::size_t planned_bytes(const KernelFactory& kernels,
                                                 const Problem& problem,
                                                 const InverseOptions& options);

  int solve(const Load& load, double energy_tolerance, bool balance) override;
  int correct(bool add) override;
  bool correct_by_host(const Eigen::VectorXd& r, bool add) override;
  bool corrects_on_host() const override { return !eager_; }
  void add_correction() override;
  void destroy(std::span<const Index> elements) override;
  void grip(const fem::Event& event) override;
  bool rebase() override;

  const solver::RenewedUpdate* update() const override { return update_.get(); }
  const Eigen::MatrixXd* grip_factor() const override {
    return eager_ ? &grips_.matrixLLT() : DeviceRoute::grip_factor();
  }
  std::vector<BufferPlan> buffers() const override;
  std::size_t host_solves() const override { return intact_->solved(); }
  void add_to(solver::FrameShape& shape) const override {
    if (!intact_->is_dense()) shape.entries = intact_->factor().entries();
    shape.columns_there = columns_there_;
    shape.columns_refined = update_ && base_of(*update_).refines();
    shape.inverse_bytes = stored_.real_bytes();
    if (!update_) return;
    const solver::Deferred& deferred = update_->deferred();
    shape.columns = static_cast<std::size_t>(deferred.rank() - deferred.grips());
    shape.damage_there = damage_solution_ && deferred.events() > 0 &&
                         damage_solution_->takes(deferred.rank(), deferred.grips());
  }

 private:
  void fill_base(const HostInverse& host);
  [[nodiscard]] bool wants_refinement(const HostInverse& host, const fem::DamagedBody& body) const;
  void ensure_base();
  [[nodiscard]] const DenseInverse* exact_base(const HostInverse& host) const;
  void read_columns();
  void bind();
  void new_base(bool with_columns);
  void extend_exact();
  void hold_loads(const Load& load);
  void record_solution(Field field, std::uint32_t chunks, bool add);
  void solve_deferred(const Load& load, double energy_tolerance, bool balance);
  [[nodiscard]] Loaded set_coefficients(const Load& load, const Eigen::VectorXd& of_damage);
  void solve_on_exact(bool balance);
  void solve_eager(const Load& load, bool balance);
  bool update_eager(std::span<const Index> elements);
  void correct_eager();
  void record_addition();
  void factor_grips();
  [[nodiscard]] Loaded grip_forces(Field field, std::span<const double> displacement) const;
  void follow_update();
  [[nodiscard]] bool can_renew() const;
  [[nodiscard]] std::uint32_t next_columns() const;
  void make_next();
  void renew();
  void begin_next();
  void catch_up();
  [[nodiscard]] bool take_next();
  void defer();

  const KernelFactory& kernels_;
  const Problem& problem_;
  const fem::DamagedBody& body_;
  Fields& fields_;
  std::shared_ptr<const HostInverse> intact_;
  InverseOptions options_;
  bool eager_, damage_;
  int bases_ = 0;                // of update_, whose columns are in exact_
  bool base_stale_ = false;      // base_ is that of an earlier one
  bool columns_there_ = false;   // new columns are read from base_
  std::size_t base_events_ = 0;  // of the body that base_ is to be made of
  bool renews_ = false;          // bases are made anew, base_ by next_
  KernelFactory stored_;         // in the precision that base_ is stored in
  DenseInverse base_;
  std::unique_ptr<DamageSolution> damage_solution_;  // null: the host has the small matrices alone
  std::unique_ptr<solver::RenewedUpdate> update_;    // empty while eager; reads columns of base_
  // Where renews_: the next base's inverse, of the body after so many events, what its making goes
  // by, whether its base has tried to read columns there, and the columns of that.
  std::unique_ptr<InverseUpdate> next_;
  std::size_t next_events_ = 0;
  solver::DamageMatrices between_;
  bool next_tried_ = false;
  std::unique_ptr<ExactColumns> next_exact_;
  // The update's columns and those of loads, as they came: where each column is among them.
  std::unique_ptr<ExactColumns> exact_;
  std::vector<Index> place_;       // of the update's columns
  std::vector<Index> load_place_;  // of each unknown's unit load; kNone: it has none
  std::vector<Index> all_;         // every unknown: the loads of a residual
  Eigen::VectorXd coefficients_, residual_, correction_;
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
    ReadAlong::What along = ReadAlong::What::nothing;
  };
  Recorded quiet_, checked_;
};

}  // namespace sunder::gpu
