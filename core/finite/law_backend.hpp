// SPDX-License-Identifier: Apache-2.0
// What statics at finite deformation and motion share as backends, on a device or by the host
// alone: the fields of a displacement by the laws of its elements, forces of grips between frames,
// what a scene may ask of them, and how the host goes on where the device is lost.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/hyperelastic_pass.hpp"
#include "solver/finite_steps.hpp"
#include "solver/frame_cost.hpp"
#include "solver/instrument_block.hpp"
#include "sunder/backend.hpp"
#include "sunder/error.hpp"

namespace sunder::finite {

/// What computes: the host, with a device or without.
struct Machine {
  BackendInfo info;         ///< backend, device, driver, precision
  std::size_t memory = 0;   ///< bytes that the host has free
  Index largest_dense = 0;  ///< unknowns whose dense inverse a buffer of the device holds
  Index most_dense = 0;  ///< unknowns of which an inverse is worth its making; no more than those
  /// A device that holds states of such a body, by such a route, with L-BFGS of so many pairs.
  /// Empty: the host alone computes. It owns what the device needs.
  std::function<std::unique_ptr<solver::FiniteDevice>(const fem::HyperelasticBody& body,
                                                      Route route, int pairs)>
      device = {};
};

/// The backend of statics or of motion, as the problem asks. Throws DeviceError for options that a
/// body with tangents of its own cannot serve, InputError where there is no room for its bases.
[[nodiscard]] std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs,
                                              Machine machine);

class LawBackend : public Backend {
 public:
  BackendInfo info() const override;
  std::vector<BufferPlan> buffers() const override;
  std::vector<KernelPlan> kernels() const override;
  std::vector<std::string> warnings() const override;

 protected:
  LawBackend(std::shared_ptr<const Problem> shared, Needs needs, Machine machine);

  /// Inverse, factor, or (in motion on a device) cg.
  [[nodiscard]] Route route() const { return route_; }
  [[nodiscard]] bool by_inverse() const { return route_ == Route::inverse; }
  /// What is computed: the problem, or what it becomes where cracks split: new nodes and unknowns
  /// come after its own, which keep their numbers.
  [[nodiscard]] const Problem& computed() const { return *now_.problem; }
  [[nodiscard]] const fem::HyperelasticBody& body() const { return *now_.body; }
  [[nodiscard]] const fem::HyperelasticBody& intact() const { return intact_; }
  /// What take_new_bases() tells.
  [[nodiscard]] NewBases& new_bases() { return new_bases_; }
  /// Null: the host.
  [[nodiscard]] solver::FiniteDevice* device() const { return now_.device.get(); }
  [[nodiscard]] solver::FiniteDevice* device_of_intact() const { return device_of_intact_.get(); }

  /// What moves or rests, for the texts: "motion", "a recent tangent with inertia" and so on.
  struct Words {
    std::string what, tangent, iteration;
  };
  [[nodiscard]] virtual Words words() const = 0;
  /// The body with the patches of pooled volume that it has now.
  [[nodiscard]] virtual const solver::RestingBody& resting() const = 0;
  /// Per element 1: its stress is 0.
  [[nodiscard]] virtual std::span<const std::uint8_t> without_stress() const { return destroyed(); }

  /// An operation that may find the device lost: then the host does it, from the state before.
  template <class Operation>
  auto attempt(Operation&& operation) {
    try {
      return operation();
    } catch (const DeviceLost& error) {
      if (!now_.device) throw;
      lost_ = error.what();
      leave_device();
      now_.device.reset();
      device_of_intact_.reset();
    }
    return operation();
  }
  /// The host goes on from the state before the operation.
  virtual void leave_device() = 0;

  NewBases take_new_bases() override { return std::exchange(new_bases_, {}); }
  std::shared_ptr<InstrumentForces> instrument_forces() override;
  void take_over_instrument_forces(std::shared_ptr<InstrumentForces> forces) override;
  /// Of the last solution, of the grips of computed(); empty: unknown.
  [[nodiscard]] virtual Eigen::MatrixXd grip_stiffness() = 0;
  /// What computes the fields of a body.
  struct Computed {
    std::shared_ptr<const Problem> problem;
    std::unique_ptr<const fem::HyperelasticBody> body;
    std::unique_ptr<fem::HyperelasticPass> pass;
    std::unique_ptr<solver::FiniteDevice> device;  ///< null: the host alone
  };
  /// To be called where nodes have parted: from now on the body is computed as it is now. Returns
  /// what was before, which must live while anything reads it.
  [[nodiscard]] Computed part();
  [[nodiscard]] std::shared_ptr<const Problem> body_now() const;
  /// To be called where other unknowns are gripped: from now on the body is computed so. Returns as
  /// part() does.
  [[nodiscard]] Computed take_grips(std::span<const Index> before);
  std::string why_no_grasp() const override;
  /// Forces of grips on `computed()`, per unknown, as those of gripped_dofs().
  void sum_grips(const Eigen::VectorXd& forces, std::span<double> reactions) const;

  /// The last solution; fields of the one before no longer hold.
  void moved_to(const std::vector<double>& u);
  /// After a solution: to who has asked for the forces of grips.
  void publish_instruments();

  void do_set_load(const Load& load) override;
  StressSummary do_stress() override;
  Deformation do_deformation() override;
  void do_cut_off(std::span<const Index> elements) override {
    now_.pass->cut_off(elements);
    cut_off_.insert(cut_off_.end(), elements.begin(), elements.end());
    deformation_.reset();
  }
  void do_destroy(std::span<const Index> elements) override;
  void do_exclude_candidates(std::span<const Index> elements) override;
  void do_read_displacement(std::span<double> displacement) const override;
  void do_read_displacement(std::span<const Index> nodes,
                            std::span<Vec3> displacement) const override;
  void do_read_stress(std::span<Voigt> stress) const override;
  Voigt do_read_stress(Index element) const override { return stress_[element]; }

  Load load_;              // on computed()
  std::vector<double> u_;  // of the last solution

 private:
  [[nodiscard]] Computed computed_as(std::shared_ptr<const Problem> problem);
  [[nodiscard]] Computed compute_as(const std::shared_ptr<const Problem>& problem);
  [[nodiscard]] Route chosen_route() const;
  void leave_inverse_if_outgrown(const Problem& next);
  std::size_t check_options();

  std::vector<Voigt> stress_;               // of the last stress()
  bool stress_known_ = false;               // it is that of u_
  std::optional<Deformation> deformation_;  // of u_, once asked for
  std::vector<const Law*> laws_;
  fem::HyperelasticBody intact_;
  Machine machine_;
  Route route_;
  solver::LawCost cost_;  // of the host alone
  std::size_t factor_entries_ = 0;
  bool outgrown_ = false;  // the body's inverse no longer fits the device
  std::string lost_;       // why the device is gone; empty: it is not
  Computed now_;
  std::unique_ptr<solver::FiniteDevice> device_of_intact_;
  std::vector<Index> cut_off_;  // elements
  std::vector<std::uint8_t> excluded_;
  std::optional<solver::InstrumentBlock> instruments_;  // once asked for
  NewBases new_bases_;                                  // since they were asked for
  std::vector<double> reactions_, held_;                // per gripped_dofs()
};

}  // namespace sunder::finite
