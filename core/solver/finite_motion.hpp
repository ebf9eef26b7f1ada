// SPDX-License-Identifier: Apache-2.0
// Motion at finite deformation (method.md "Motion"): lumped masses, steps of time by BDF2, by
// backward Euler at the start and after what the second order does not survive. A step is a minimum
// of the energy with the step's inertia, found on a base as in statics. Nothing is frozen: pieces
// that are cut off go on as they went.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "solver/finite_minimiser.hpp"
#include "solver/finite_renewal.hpp"

namespace sunder::solver {

struct FiniteMotionOptions {
  /// Bound of the relative error of stress of a step, and beside it of |residual| over all forces
  /// that act, those of inertia too.
  double tolerance = 1e-4, residual = 1e-2;
  StressMeasure stress = StressMeasure::cauchy;  ///< that is meant
  double damping = 0;                            ///< force per mass and velocity [1/s]
  Vec3 gravity = Vec3::Zero();                   ///< [mm/s^2]
  int most_iterations = 0;                       ///< back-solves of a step; 0: as many as it takes
  int pairs = 5;                                 ///< of L-BFGS
  int most_back_solves = 25;                     ///< on one base
  int most_factors = 12;  ///< of one step, made where the base stalls; not under a cap
  bool turn = true;       ///< the base by the nodes' rotations
  Index most_rank = 300;  ///< unknowns that what has left touches, before a new base is made
  int renew_after = 8;  ///< back-solves of a step after which the base is renewed beside the steps
  int taken_after = 2;  ///< steps after which a renewed base is taken; 0: it is made at once
  std::chrono::milliseconds rest{0};  ///< the thread's, before it begins
};

/// Where the work of a step went [N mm], each term by its own formula:
/// work = change of kinetic, strain and gravity's energy + damped + scheme + unsolved.
struct FiniteMotionBalance {
  double work = 0;      ///< of forces and grips, by the trapezoidal rule
  double damped = 0;    ///< by damping
  double scheme = 0;    ///< what the scheme loses: of kinetic and strain energy, and of work
  double unsolved = 0;  ///< of the residual: what the iteration has left
  double broken = 0;    ///< strain energy of what left since the step before, gone with it
};

/// How a step ended: at rest in its own moving frame, or by the cap, which breaks the promise, or
/// `stuck`: then the state is still the one before it.
struct FiniteMotionReport {
  bool capped = false, stuck = false;
  bool second_order = false;                        ///< it was a step of BDF2
  double residual = 0, error = 0, contraction = 0;  ///< as in FiniteStaticsReport
  int back_solves = 0, factors = 0;
  Index rank = 0;
  FiniteMotionBalance balance;
};

class FiniteMotion {
 public:
  /// `mass` per node [t], 0 only where all axes are supported or no element is. The body and the
  /// options' problem must outlive it; what is destroyed is read live. Starts undeformed, at rest.
  FiniteMotion(const fem::HyperelasticBody& body, std::span<const double> mass,
               FiniteMotionOptions options = {});

  /// A step of dt [s] > 0 towards the load at its end.
  FiniteMotionReport step(const Load& load, double dt);

  /// (3 * nodes) [mm], [mm/s]
  [[nodiscard]] const std::vector<double>& displacement() const { return u_; }
  [[nodiscard]] const std::vector<double>& velocity() const { return v_; }
  /// Sets the velocities, supports' to 0; the next step is one of backward Euler.
  void set_velocity(std::span<const double> v);
  /// (3 * nodes) [N] at displacement()
  [[nodiscard]] std::span<const double> internal_forces() const { return state_.f; }

  /// These have just left; the body says so already.
  void destroyed(std::span<const Index> elements);

  [[nodiscard]] double strain_energy() const { return state_.energy; }  ///< [N mm]
  [[nodiscard]] double kinetic_energy() const;                          ///< [N mm]
  [[nodiscard]] double gravity_energy() const;                          ///< 0 undeformed [N mm]
  [[nodiscard]] Vec3 momentum() const;                                  ///< [t mm/s]
  [[nodiscard]] Vec3 angular_momentum() const;  ///< about the origin [t mm^2/s]

 private:
  using Report = FiniteMotionReport;
  /// v = rate (u - u_from), a = rate (v - v_from): what a scheme says of the step's end.
  struct Scheme {
    bool second_order;
    double rate;  // [1/s]
    std::vector<double> u_from, v_from;
  };
  [[nodiscard]] Scheme scheme(double dt) const;
  [[nodiscard]] FiniteTarget target(const Load& load, const Scheme& by);
  [[nodiscard]] bool begin(const FiniteTarget& target, double dt);
  [[nodiscard]] bool ensure_base(const fem::Inertia& inertia, Report& report);
  [[nodiscard]] bool renew(const std::vector<double>& u, const fem::Inertia& inertia,
                           Report& report);
  [[nodiscard]] bool minimise(const FiniteTarget& target, Report& report);
  void take(const FiniteTarget& end, const Scheme& by, double dt, Report& report);
  [[nodiscard]] FiniteMotionBalance balance(const FiniteTarget& end, const Scheme& by,
                                            std::span<const double> v);
  void renew_if_due(const fem::Inertia& inertia, Report& report);

  FiniteMotionOptions options_;
  RestingBody moving_;
  FinitePotential potential_;
  FiniteMinimiser minimiser_;
  FiniteScale scale_;
  fem::TangentPattern pattern_;
  std::vector<double> node_mass_, mass_;  // per node, per unknown
  std::vector<double> u_, v_, u_before_, v_before_;
  double dt_before_ = 0;               // of the last step; 0: the state before it is none to go by
  int euler_ = 1;                      // so many steps of backward Euler are still to come
  std::vector<std::uint8_t> gripped_;  // per unknown
  Eigen::VectorXd load_, reaction_;    // at the state, without gravity; of grips, else 0
  double broken_ = 0;                  // strain energy that left since the last step
  std::vector<double> ahead_;
  FiniteState state_, next_;
  std::unique_ptr<FiniteBase> base_;
  int since_asked_ = 0;
  FiniteRenewal renewal_;  // last: its thread reads pattern_ and mass_
};

}  // namespace sunder::solver
