// SPDX-License-Identifier: Apache-2.0
// One frame: the displacement under a load by the backend's route, checked and refined until its
// stress error is under the scene's tolerance.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "cpu_reference/choose_route.hpp"
#include "cpu_reference/frame_fields.hpp"
#include "cpu_reference/routes.hpp"
#include "engine/energy_check.hpp"
#include "engine/frame_check.hpp"
#include "engine/recent_checks.hpp"

namespace sunder::cpu_reference {

class FrameSolver {
 public:
  /// What it refers to must outlive it. Solutions that hold are published in `fields`. `intact` is
  /// null where its factor does not fit the memory.
  FrameSolver(const ChosenRoute& chosen, const DamagedBody& body, const IntactBody* intact,
              InverseRoute& route, FrameFields& fields);

  void set_load(const Load& load);
  [[nodiscard]] const Load& load() const { return load_; }
  /// Throws NumericalError when the solution cannot be brought under the tolerance.
  SolveReport solve();
  /// Force that the grips exert on the body, one per gripped unknown.
  [[nodiscard]] std::span<const double> reactions() const { return reactions_; }
  /// An event has changed the body.
  void event();

 private:
  SolveReport solve_everywhere();
  SolveReport solve_condensed();
  [[nodiscard]] std::optional<SolveReport> solve_on_region(engine::EnergyCheck& check);
  [[nodiscard]] engine::FrameCheck* check_of_load();

  void solve_by(InverseRoute& route, SolveReport& report);
  void look_at(SolveReport& report);
  void hand_out();

  void check_fully(SolveReport& report);
  void refine(InverseRoute& route, SolveReport& report);
  [[nodiscard]] double correction(InverseRoute& route, SolveReport& report);
  [[nodiscard]] bool is_off(double error) const;
  void polish(SolveReport& report);

  [[nodiscard]] const Problem& problem() const { return body_.problem(); }
  [[nodiscard]] double tolerance() const { return problem().scene().solver.tolerance; }
  [[nodiscard]] bool yardstick() const;
  /// Residual and stress come from the fields; the yardstick has loops of its own.
  [[nodiscard]] bool by_fields() const { return checks_.has_value(); }
  [[nodiscard]] double grip_force(std::size_t g) const;
  [[nodiscard]] double largest_u() const;
  [[nodiscard]] double largest_in_region() const;
  [[nodiscard]] engine::FrameCheck::Solution solution() const;

  const ChosenRoute& chosen_;
  const DamagedBody& body_;
  const IntactBody* intact_;
  InverseRoute& route_;
  FrameFields& fields_;
  std::optional<engine::RecentChecks<engine::FrameCheck>>
      checks_;  // of a deferred update that knows u everywhere
  std::optional<engine::RecentChecks<engine::EnergyCheck>> energy_checks_;  // of a condensed body
  std::vector<double> anchors_;  // stiffness of each gripped unknown's anchor

  // Stress error up to which a base is kept: what fp64 promises, or somewhat above what a fresh one
  // came to where that is more.
  double keeps_;

  Load load_;
  engine::FrameCheck* check_ = nullptr;  // of load_, of checks_
  Eigen::VectorXd force_, u_, du_, product_, r_;
  std::vector<double> reactions_;
  double free_residual_ = 0;  // |r_|
  double unrefined_ = 0;      // error of the last full check's solution before it was refined
  double largest_ = 0;        // stress of the last solution
};

}  // namespace sunder::cpu_reference
