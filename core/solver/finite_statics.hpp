// SPDX-License-Identifier: Apache-2.0
// Static equilibrium at finite deformation (method.md "Finite deformation"): minimum of the energy
// less the work of the load, on a base that outlives the step and follows what is destroyed.
//
// The base is the factor of the projected tangent at a recent equilibrium. L-BFGS on top of it
// finds the next one, with a line search on the energy; where that stalls a new factor is made at
// the state reached; where that ends nowhere the load is approached in smaller steps.
#pragma once

#include <memory>
#include <vector>

#include "material/finite_stress.hpp"
#include "solver/finite_base.hpp"
#include "solver/finite_minimiser.hpp"
#include "solver/finite_potential.hpp"
#include "solver/finite_start.hpp"

namespace sunder::solver {

struct FiniteStaticsOptions {
  /// Bound of the relative error of stress: largest error of an element over the largest stress.
  double tolerance = 1e-4;
  /// The stress that is meant: cauchy_stress or biot_stress.
  fem::StressFunction stress = cauchy_stress;
  /// Beside it |internal forces - load| of free unknowns over all forces that act at the step's
  /// begin or end, whichever are larger.
  double residual = 1e-2;
  int pairs = 5;              ///< of L-BFGS
  int most_back_solves = 25;  ///< on one base
  int most_factors = 20;      ///< of one approach, made where the base stalls
  int most_halvings = 12;     ///< of the load's increment
  bool turn = true;           ///< the base by the nodes' rotations
  Index most_rank = 300;      ///< unknowns that what has left touches, before a new base is made
  int renew_after = 8;        ///< back-solves of a step after which the base is renewed
};

/// How a step ended.
struct FiniteStaticsReport {
  bool at_rest = false;
  /// Of the load's increment: 1 at rest, less where no equilibrium could be found beyond; the state
  /// is the last one at rest.
  double share = 0;
  double residual = 0;     ///< as in the options
  double error = 0;        ///< estimate of the relative error of stress
  double contraction = 0;  ///< measured: how much of an error an iteration leaves
  int back_solves = 0, factors = 0, load_steps = 0, damped_steps = 0;
  Index rank = 0;  ///< unknowns by which the base differs from the body
  FrozenParts frozen;
};

class FiniteStatics {
 public:
  /// At rest at u = 0. The body must outlive it; what is destroyed is read live.
  explicit FiniteStatics(const fem::HyperelasticBody& body, FiniteStaticsOptions options = {});

  /// From the last state at rest to the load.
  FiniteStaticsReport solve(const Load& load);
  /// (3 * nodes) [mm]
  [[nodiscard]] const std::vector<double>& displacement() const { return u_; }
  /// (3 * nodes) [N] at displacement(); what is destroyed or frozen adds nothing.
  [[nodiscard]] std::span<const double> internal_forces() const { return f_; }
  /// Per element 1: destroyed, or of a piece that nothing holds, whose stress has no meaning.
  [[nodiscard]] std::span<const std::uint8_t> out() const { return resting_.out(); }

  /// These have just left; the body says so already.
  void destroyed(std::span<const Index> elements);
  /// Anything else about the body has changed: elements are back, laws are others.
  void body_changed();

 private:
  [[nodiscard]] bool renew(const std::vector<double>& u, fem::Tangent kind,
                           FiniteStaticsReport& report);
  void predict(const FiniteTarget& target);
  void move_grips(const FiniteTarget& target);
  [[nodiscard]] bool by_new_factors(const FiniteTarget& target, FiniteStaticsReport& report);
  [[nodiscard]] bool minimise(const FiniteTarget& target, int most, FiniteStaticsReport& report);
  [[nodiscard]] bool approach(const FiniteTarget& target, FiniteStaticsReport& report);

  const fem::HyperelasticBody& body_;
  FiniteStaticsOptions options_;
  RestingBody resting_;
  FinitePotential potential_;
  std::vector<double> u_, f_;     // of the last state at rest
  std::vector<double> before_;    // the one before it; empty: the body has changed since
  FiniteTarget reached_, begin_;  // their loads
  std::vector<Index> order_;      // of the factor
  std::unique_ptr<FiniteBase> base_;
  FiniteMinimiser minimiser_;
  FiniteScale scale_;
  FiniteState state_, probe_;
  Eigen::VectorXd motion_, following_;
};

}  // namespace sunder::solver
