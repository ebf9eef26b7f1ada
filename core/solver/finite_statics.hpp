// SPDX-License-Identifier: Apache-2.0
// Static equilibrium at finite deformation (method.md "Finite deformation"): minimum of the energy
// less the work of the load, on a base that outlives the step, follows what is destroyed and is
// renewed beside the steps.
//
// In this order: L-BFGS on the base; new factors at the states reached; smaller steps of the load;
// a damped path, spread over several calls; a report that nothing was found, with the last state at
// rest kept.
#pragma once

#include <memory>
#include <vector>

#include "body/parting.hpp"
#include "solver/damped_path.hpp"
#include "solver/finite_minimiser.hpp"
#include "solver/finite_renewal.hpp"

namespace sunder::solver {

struct FiniteStaticsOptions {
  /// Bound of the relative error of stress: largest error of an element over the largest stress.
  double tolerance = 1e-4;
  StressMeasure stress = StressMeasure::cauchy;  ///< that is meant
  /// Beside it |internal forces - load| of free unknowns over all forces that act at the step's
  /// begin or end, whichever are larger.
  double residual = 1e-2;
  int pairs = 5;              ///< of L-BFGS
  int most_back_solves = 25;  ///< on one base
  int most_factors = 12;      ///< of one approach, made where the base stalls
  int most_halvings = 3;      ///< of the load's increment, before the damped path
  bool inverse = false;       ///< bases that outlive a step are kept as dense inverses
  bool turn = true;           ///< the base by the nodes' rotations
  Index most_rank = 300;      ///< unknowns that what has left touches, before a new base is made
  int renew_after = 8;        ///< back-solves beyond two a step, after which the base is renewed
  /// Steps after which it is looked whether the rest is stable; twice as many each time that it is
  /// and the base has not been renewed.
  int check_after = 4, check_after_most = 32;
  /// Renewals are made by a thread and taken so many calls of solve() later, what it says of
  /// stability twice as many; 0: they are made at once.
  int taken_after = 2;
  std::chrono::milliseconds rest{0};  ///< the thread's, before it begins
  int most_damped_steps = 5;          ///< of a call
  int most_path_steps = 120;          ///< of a damped path, before it is given up
};

/// How a step ended: at rest, unfinished, or neither: then the state is the rest before the step.
struct FiniteStaticsReport {
  bool at_rest = false;
  /// A damped path is on its way: the state is no equilibrium, the next call goes on from it.
  bool unfinished = false;
  double share = 0;        ///< of the load's increment up to which rests were found: 1 at rest
  double residual = 0;     ///< as in the options
  double error = 0;        ///< estimate of the relative error of stress
  double contraction = 0;  ///< measured: what an iteration leaves of an error
  int back_solves = 0, factors = 0, load_steps = 0, damped_steps = 0;
  int buckled = 0;  ///< how often an unstable rest was left
  Index rank = 0;   ///< unknowns by which the base differed from the body
  FrozenParts frozen;
  NewBases new_bases;  ///< made by the step, or beside the steps and taken by it
};

class FiniteStatics {
 public:
  /// At rest at u = 0. The body must outlive it; what is destroyed is read live.
  explicit FiniteStatics(const fem::HyperelasticBody& body, FiniteStaticsOptions options = {},
                         FiniteDevice* device = nullptr);

  /// From the last state at rest, or on a damped path from the present one, to the load.
  FiniteStaticsReport solve(const Load& load);
  /// (3 * nodes) [mm]
  [[nodiscard]] const std::vector<double>& displacement() const { return shown_.u; }
  /// (3 * nodes) [N] at displacement(); what is destroyed or frozen adds nothing.
  [[nodiscard]] std::span<const double> internal_forces() const { return shown_.f; }
  /// Stiffness [N/mm] that all grips of the body feel there (grip_stiffness.hpp); empty: there is
  /// no base to find it by.
  [[nodiscard]] Eigen::MatrixXd grip_stiffness();
  /// Per element 1: destroyed, or of a piece that nothing holds, whose stress has no meaning.
  [[nodiscard]] std::span<const std::uint8_t> out() const { return resting_.out(); }
  [[nodiscard]] const RestingBody& resting() const { return resting_; }

  /// The device is gone: from the last state at rest on by the host.
  void leave_device();

  /// Goes on from another one's last rest, with its base: of the same body before nodes parted.
  void go_on_from(FiniteStatics& before, const fem::Parting& parting);

  /// The same where other unknowns are gripped, all nodes as they were: its base holds them as
  /// well, unless that holds others by itself.
  void go_on_from(FiniteStatics& before);

  /// These have just left; the body says so already.
  void destroyed(std::span<const Index> elements);
  /// Anything else about the body has changed: elements are back, laws are others.
  void body_changed();

 private:
  using Report = FiniteStaticsReport;
  void update_parts();
  [[nodiscard]] bool climb(const FiniteTarget& end, Report& report);
  [[nodiscard]] bool approach(const FiniteTarget& target, Report& report);
  [[nodiscard]] bool ensure_base(const std::vector<double>& u, Report& report);
  [[nodiscard]] bool renew(const std::vector<double>& u, fem::Tangent kind, Report& report);
  void predict(const FiniteTarget& target);
  void extrapolate(const FiniteTarget& target);
  void move_grips(const FiniteTarget& target);
  [[nodiscard]] bool minimise(const FiniteTarget& target, int most, Report& report);
  [[nodiscard]] bool by_kept_pressures(const FiniteTarget& target, Report& report);
  void note_pressures();
  [[nodiscard]] bool by_new_factors(const FiniteTarget& target, int most, Report& report);
  [[nodiscard]] bool leave_saddle(const FiniteTarget& target, Report& report);
  [[nodiscard]] bool push(const FiniteTarget& target, const Eigen::VectorXd& mode);
  void follow_path(const FiniteTarget& end, Report& report);
  void rest_at(const FiniteTarget& target);
  void go_back();
  void take_renewed(Report& report);
  void judged(bool stable);
  void ask(bool base, bool judgement);
  void renew_if_due(const FiniteTarget& end, Report& report);

  const fem::HyperelasticBody& body_;
  FiniteStaticsOptions options_;
  RestingBody resting_;
  FinitePotential potential_;
  FiniteMinimiser minimiser_;
  FiniteScale scale_;
  fem::PatternOnDemand pattern_;
  std::vector<double> u_;           // the last state at rest
  std::vector<double> before_;      // the one before it; empty: the body has changed since
  FiniteTarget reached_, begin_;    // their loads
  double acting_ = 0;               // forces at the last state at rest
  std::vector<double> step_begin_;  // the last state at rest before the step that is on its way
  FiniteTarget step_begin_target_;
  double climbed_ = 0;  // share of its load at which a rest was found
  FiniteState shown_, state_, probe_;
  // With kept pressures: where an approach began, and those of the last state at rest.
  std::vector<double> predicted_, pressures_;
  Eigen::VectorXd motion_, following_;
  std::unique_ptr<FiniteBase> base_;
  bool parted_ = false;     // a base that is made within a step keeps no inverse
  bool suspected_ = false;  // the last state at rest may be unstable
  bool first_ = true;       // nothing has come to rest so far
  int worn_ = 0;            // back-solves beyond a few a step since the base was made or asked for
  int since_check_ = 0, since_asked_ = 0, check_after_;
  bool judged_alone_ = false;  // what is asked for is no base
  bool keeps_pressures_;       // kept_pressures.hpp
  DampedPath path_;
  FiniteRenewal renewal_;  // its thread reads pattern_
  bool linear_;            // by law "linear" alone
};

}  // namespace sunder::solver
