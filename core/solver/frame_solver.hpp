// SPDX-License-Identifier: Apache-2.0
// One frame on any device: the displacement under a load, checked and refined until its stress
// error is under the scene's tolerance.
#pragma once

#include <memory>
#include <optional>

#include "solver/energy_check.hpp"
#include "solver/frame_check.hpp"
#include "solver/frame_device.hpp"
#include "solver/recent_checks.hpp"

namespace sunder::solver {

class FrameSolver {
 public:
  /// Both must outlive it. `problem`: what the device solves.
  FrameSolver(const Problem& problem, FrameDevice& device);

  /// Solves for a load that the device has been given. Throws NumericalError when the solution
  /// cannot be brought under the tolerance.
  SolveReport solve(const Load& load);
  /// Whether the next solve() of this load leaves the checks out.
  [[nodiscard]] bool known(const Load& load) const;
  /// The last solution is known at all unknowns, not on a region alone.
  [[nodiscard]] bool everywhere() const { return everywhere_; }
  /// An event has changed the body.
  void event();
  /// Other unknowns are gripped: loads from now on are of another kind.
  void grips_changed();

  /// What is known of loads so far, to go back to: the next solution refines as it would have then.
  class State;
  [[nodiscard]] std::shared_ptr<const State> state() const;
  void restore(const State& state);

 private:
  SolveReport solve_everywhere(const Load& load);
  SolveReport solve_condensed(const Load& load);
  [[nodiscard]] std::optional<SolveReport> solve_known(const Load& load);
  [[nodiscard]] std::optional<SolveReport> solve_by_base(const EnergyCheck& check);
  [[nodiscard]] std::optional<SolveReport> refine_on_region(EnergyCheck& check,
                                                            const CheckedLoads::Sum& expected,
                                                            const Load& load);
  [[nodiscard]] FrameCheck* check_of(const Load& load);
  [[nodiscard]] int bases() const;
  [[nodiscard]] bool speaks_for_itself() const;

  void solve_once(double energy_tolerance, Residual residual, SolveReport& report);
  void read_balance(SolveReport& report);
  void check_fully(SolveReport& report);
  [[nodiscard]] bool adds_at_once(int attempt, double before) const;
  void refine(SolveReport& report, bool by_base);
  [[nodiscard]] bool misses_precision(double error) const;
  [[nodiscard]] double error_of_rounding() const;
  void polish(SolveReport& report);

  [[nodiscard]] double tolerance() const { return problem_.scene().solver.tolerance; }
  [[nodiscard]] FrameCheck::Solution solution() const;

  const Problem& problem_;
  FrameDevice& device_;
  Precision precision_;
  // Of a deferred update that knows u everywhere, and of iterations.
  std::optional<RecentChecks<FrameCheck>> checks_;
  std::optional<RecentChecks<EnergyCheck>> energy_checks_;  // of a condensed body

  // Stress error up to which a base is kept: what the precision promises, or somewhat above what a
  // fresh one came to where that is more.
  double kept_error_;
  int events_ = 0;
  mutable std::optional<double> stress_of_1_mm_;  // that rounding of it may cost [MPa]; once asked

  const Load* load_ = nullptr;   // of the solve() in work
  FrameCheck* check_ = nullptr;  // of that load, of checks_
  Balance balance_;              // of the solution in work
  double unrefined_ = 0;         // error of the last checked solution before it was refined
  bool everywhere_ = true;
  bool refined_ = false;  // the solution in work is more than what the route gives by itself
  // By what is likely to be wanted: the last one had a full check; the last full check added its
  // first correction.
  bool checked_fully_ = true, first_adds_ = false;
  // The last frame, where a multiple of its load has the same relative error.
  struct Last {
    Load load;
    SolveReport report;
    bool holds = false;
  };
  Last last_;
  // What the last full check of a condensed frame has said of its base.
  struct CheckedBase {
    int number = 0;  // 0: there was none
    double unrefined = 0;
    SolveReport report;
    bool other_grips = false;  // than then
  };
  CheckedBase checked_base_;
};

class FrameSolver::State {
 public:
  explicit State(const FrameSolver& of)
      : checks_(of.checks_),
        energy_checks_(of.energy_checks_),
        kept_error_(of.kept_error_),
        events_(of.events_),
        last_(of.last_),
        checked_base_(of.checked_base_),
        checked_fully_(of.checked_fully_),
        first_adds_(of.first_adds_) {}

 private:
  friend class FrameSolver;
  std::optional<RecentChecks<FrameCheck>> checks_;
  std::optional<RecentChecks<EnergyCheck>> energy_checks_;
  double kept_error_;
  int events_;
  Last last_;
  CheckedBase checked_base_;
  bool checked_fully_, first_adds_;
};

}  // namespace sunder::solver
