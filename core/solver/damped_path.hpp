// SPDX-License-Identifier: Apache-2.0
// Past a limit point, where no equilibrium is near: the body moves there with a fictitious uniform
// mass, backward Euler a step, its velocities set to zero at each peak of the kinetic energy
// (method.md "Finite deformation", Limit points).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solver/finite_minimiser.hpp"

namespace sunder::solver {

class DampedPath {
 public:
  DampedPath(const FinitePotential& potential, FiniteMinimiser& minimiser,
             fem::PatternOnDemand& pattern)
      : potential_(potential), minimiser_(minimiser), pattern_(pattern) {}

  struct Cost {
    int back_solves = 0, factors = 0;
  };
  /// At rest where `u` is.
  void begin(const std::vector<double>& u);
  void end() { running_ = false; }
  [[nodiscard]] bool running() const { return running_; }
  [[nodiscard]] int steps() const { return steps_; }  ///< since begin()
  /// What has left takes its base with it.
  void body_changed() { base_.reset(); }
  /// A step of time towards the target. False: stuck, whatever the step.
  [[nodiscard]] bool step(const FiniteTarget& target, Cost& cost);
  /// Where the body is now, without inertia.
  [[nodiscard]] const FiniteState& state() const { return state_; }
  /// Its velocities have just been set to zero: an equilibrium may be near.
  [[nodiscard]] bool paused() const { return paused_; }

 private:
  [[nodiscard]] bool try_step(const FiniteTarget& target, Cost& cost);
  [[nodiscard]] bool renew(Cost& cost);
  void take();

  const FinitePotential& potential_;
  FiniteMinimiser& minimiser_;
  fem::PatternOnDemand& pattern_;
  bool running_ = false, paused_ = false, easy_ = false, hard_ = false;
  int steps_ = 0;
  double inertia_ = 0;  // mass over dt squared [N/mm]
  double kinetic_ = 0;  // energy times 2 dt^2 over mass, of the last step
  double dt_ = 1;       // over the first step's
  Eigen::VectorXd velocity_, moved_;
  FiniteState state_, next_;
  std::vector<double> ahead_;
  std::unique_ptr<FiniteBase> base_;
};

}  // namespace sunder::solver
