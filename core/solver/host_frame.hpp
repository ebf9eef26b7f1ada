// SPDX-License-Identifier: Apache-2.0
// A frame whose solution is on the host: the route's, its residual and its fields, as the solver of
// a frame asks for them (frame_device.hpp).
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "body/damaged_body.hpp"
#include "body/offsets.hpp"
#include "solver/frame_device.hpp"
#include "solver/host_fields.hpp"
#include "solver/instrument_block.hpp"
#include "solver/inverse_route.hpp"

namespace sunder::solver {

class HostFrame final : public FrameDevice {
 public:
  using MakeRoute = std::function<std::unique_ptr<InverseRoute>()>;

  /// What it refers to must outlive it. `yardstick`: a plain route that others are measured by.
  /// `fall_back`: what has the word where the route fails; empty: nothing.
  HostFrame(const fem::DamagedBody& body, InverseRoute& route, HostFields& fields,
            bool yardstick = false, MakeRoute fall_back = {});

  void set_load(const Load& load);
  /// Load and solution, to go back to.
  struct State {
    Load load;
    Eigen::VectorXd u;
    std::vector<double> reactions;
    double load_squared = 0, largest = 0;
  };
  [[nodiscard]] State state() const { return {load_, u_, reactions_, load_squared_, largest_}; }
  void restore(const State& state);
  /// Other unknowns are gripped than `before`: of those that stay nothing changes, what is new is
  /// held where it is.
  void follow_grips(std::span<const Index> before);
  [[nodiscard]] const Load& load() const { return load_; }
  /// The solution in work, over all unknowns, offsets of new nodes last; solve_region() fills those
  /// of the region alone.
  [[nodiscard]] const Eigen::VectorXd& u() const { return u_; }
  /// Force that the grips exert on the body, one per gripped unknown.
  [[nodiscard]] std::span<const double> reactions() const { return reactions_; }

  [[nodiscard]] Precision precision() const override;
  [[nodiscard]] bool yardstick() const override { return yardstick_; }
  int solve(double energy_tolerance, Residual residual) override;
  [[nodiscard]] Balance balance() const override;
  Correction correct(bool add) override;
  void add_correction() override;
  bool rebase() override { return route_.rebase(); }
  bool fall_back(bool on) override;
  [[nodiscard]] const Deferred* deferred() const override { return route_.deferred(); }
  [[nodiscard]] int bases() const override { return route_.bases(); }
  [[nodiscard]] const BaseCheck& base_check() const override { return route_.base_check(); }
  [[nodiscard]] bool condensed() const override { return fields_.region() != nullptr; }
  OnRegion solve_region(double energy_tolerance) override;
  bool refines_region() const override { return route_.refines(); }
  std::optional<RefinedOnRegion> refine_region() override;
  OnRegion on_region() override;
  [[nodiscard]] int factor() const override { return route_.factor(); }
  [[nodiscard]] bool drifts() const override { return route_.drifts(); }
  [[nodiscard]] double mended() const override { return mended_; }

  /// Of computing the stress of solutions, all so far [ms].
  [[nodiscard]] double stress_ms() const { return stress_ms_; }

 private:
  void read_grips(std::span<const Index> before);
  void compute_residual();
  void make_room_for_offsets();
  void compute_stress();
  void find_reactions();
  [[nodiscard]] std::optional<double> refine();
  [[nodiscard]] const Problem& problem() const { return body_.problem(); }
  [[nodiscard]] InverseRoute& route() { return other_ ? *other_ : route_; }
  [[nodiscard]] double grip_force(std::size_t g) const;
  [[nodiscard]] std::span<const Index> gripped() const { return body_.forms().gripped(); }

  const fem::DamagedBody& body_;
  InverseRoute& route_;
  HostFields& fields_;
  bool yardstick_;
  MakeRoute fall_back_;
  std::unique_ptr<InverseRoute> other_;  // while a frame falls back
  Anchors anchors_;

  fem::Offsets offsets_;
  Load load_;
  Eigen::VectorXd force_, u_, du_, product_, r_;
  std::vector<double> reactions_;
  double load_squared_ = 0, largest_ = 0;  // of the solution in work: its load, its stress
  double mended_ = 0;
  double stress_ms_ = 0;
};

}  // namespace sunder::solver
