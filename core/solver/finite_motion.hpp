// SPDX-License-Identifier: Apache-2.0
// Motion at finite deformation (method.md "Motion"): lumped masses, steps of time by BDF2, by
// backward Euler at the start and after what the second order does not survive. A step is a minimum
// of the energy with the step's inertia, found on a base as in statics. Nothing is frozen: pieces
// that are cut off go on as they went.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "body/parting.hpp"
#include "solver/finite_minimiser.hpp"
#include "solver/finite_renewal.hpp"

namespace sunder::solver {

struct FiniteMotionOptions {
  /// Bound of the relative error of stress of a step, and beside it of |residual| over all forces
  /// that act, those of inertia too.
  double tolerance = 1e-4, residual = 1e-2;
  StressMeasure stress = StressMeasure::cauchy;  ///< that is meant
  double damping = 0;                            ///< force per mass and velocity [1/s]
  double viscosity = 0;         ///< stress per small-strain stiffness and strain rate [s]
  Vec3 gravity = Vec3::Zero();  ///< [mm/s^2]
  int most_iterations = 0;      ///< back-solves of a step; 0: as many as it takes
  int pairs = 5;                ///< of L-BFGS
  int most_back_solves = 25;    ///< on one base
  int most_factors = 20;        ///< of one step, made where the base stalls; not under a cap
  bool turn = true;             ///< the base by the nodes' rotations
  Index most_rank = 300;        ///< unknowns that what has left touches, before a new base is made
  /// Back-solves of a step after which the base is renewed beside the steps; none: 8, of steps
  /// under 1/500 s 5. A step that reaches its cap renews it in any case.
  std::optional<int> renew_after = {};
  bool inverse = false;  ///< bases keep their dense inverse
  /// Steps after which a renewed base is taken; 0: it is made at once; none: as many as its making
  /// may be thought to take, by sizes and the length of a step alone.
  std::optional<int> taken_after = {};
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

  FiniteMotionBalance& operator+=(const FiniteMotionBalance& other) {
    work += other.work;
    damped += other.damped;
    scheme += other.scheme;
    unsolved += other.unsolved;
    broken += other.broken;
    return *this;
  }
};

/// How a step ended: at rest in its own moving frame, or by the cap, which breaks the promise, or
/// `stuck`: then the state is still the one before it.
struct FiniteMotionReport {
  bool capped = false, stuck = false;
  bool still = false;         ///< nothing moved, and nothing was to be found: the state stays
  int parts = 1;              ///< into which it was split, since no other way led to its end
  bool second_order = false;  ///< it was a step of BDF2
  double residual = 0, error = 0, contraction = 0;  ///< as in FiniteStaticsReport
  int back_solves = 0, factors = 0;
  int bases = 0;  ///< made beside the steps, that it took
  Index rank = 0;
  FiniteMotionBalance balance;
  NewBases new_bases;  ///< as in FiniteStaticsReport
};

/// All that the next step goes on from, but for the base.
struct FiniteMotionPast {
  std::vector<double> u, v, u_before, v_before;  ///< (3 * nodes), of the last two states
  double dt = 0;                                 ///< between them [s]
  int euler = 1;                                 ///< steps of backward Euler that are still to come
  double time = 0;                               ///< [s]
  Eigen::VectorXd load, reaction, felt;          ///< per unknown [N]
  std::vector<double> viscous;                   ///< (3 * nodes) forces [N]; empty: none
  FiniteMotionBalance sum;
  double energy = 0;  ///< strain energy [N mm]
};

class FiniteMotion {
 public:
  /// `mass` per node [t], 0 only where all axes are supported or no element is. The body and the
  /// options' problem must outlive it; what is destroyed is read live. Starts undeformed, at rest.
  FiniteMotion(const fem::HyperelasticBody& body, std::span<const double> mass,
               FiniteMotionOptions options = {}, FiniteDevice* device = nullptr);

  /// A step of dt [s] > 0 towards the load at its end. Where none is found, the grips go there in
  /// up to 64 parts of the time.
  FiniteMotionReport step(const Load& load, double dt);

  /// (3 * nodes) [mm], [mm/s]
  [[nodiscard]] const std::vector<double>& displacement() const { return u_; }
  /// The body that moves, with its pieces.
  [[nodiscard]] const RestingBody& resting() const { return moving_; }
  [[nodiscard]] const std::vector<double>& velocity() const { return v_; }
  /// Sets the velocities, supports' to 0; the next step is one of backward Euler. What the body
  /// gains by it counts as work.
  void set_velocity(std::span<const double> v);
  /// (3 * nodes) [N] at displacement()
  [[nodiscard]] std::span<const double> internal_forces() const { return state_.f; }
  /// Per unknown: force of the grip there on the body, else 0; with what accelerates the node that
  /// it holds, or without [N].
  [[nodiscard]] const Eigen::VectorXd& grip_forces(bool with_inertia) const {
    return with_inertia ? reaction_ : felt_;
  }
  /// (3 * nodes) [N], of what is live, at the rates of the last step; empty: there are none.
  [[nodiscard]] const std::vector<double>& viscous_forces() const { return viscous_; }
  /// Stiffness [N/mm] that all grips of the body feel in the last step (grip_stiffness.hpp); empty:
  /// there is no base to find it by.
  [[nodiscard]] Eigen::MatrixXd grip_stiffness(bool with_inertia);
  /// Of all steps so far.
  [[nodiscard]] FiniteMotionBalance sum() const;

  /// The device is gone: the host goes on from there.
  void leave_device(const FiniteMotionPast& past);

  /// These have just left; the body says so already.
  void destroyed(std::span<const Index> elements);

  [[nodiscard]] FiniteMotionPast past() const {
    return {u_,    v_,        u_before_, v_before_, dt_before_, euler_,       time_,
            load_, reaction_, felt_,     viscous_,  sum(),      state_.energy};
  }
  /// Goes on from there, of the body as it is now.
  void go_on_from(const FiniteMotionPast& past);

  /// The same from another one's state, with its base: of the same body before nodes parted.
  void go_on_from(FiniteMotion& before, const fem::Parting& parting);

  /// The same where other unknowns are gripped, all nodes as they were: its base holds them as
  /// well, unless that holds others by itself.
  void go_on_from(FiniteMotion& before);

  [[nodiscard]] double time() const { return time_; }                   ///< sum of the steps [s]
  [[nodiscard]] double strain_energy() const { return state_.energy; }  ///< [N mm]
  [[nodiscard]] double kinetic_energy() const;                          ///< [N mm]
  [[nodiscard]] double gravity_energy() const;                          ///< 0 undeformed [N mm]
  [[nodiscard]] Vec3 momentum() const;                                  ///< [t mm/s]
  [[nodiscard]] Vec3 angular_momentum() const;  ///< about the origin [t mm^2/s]

 private:
  using Report = FiniteMotionReport;
  [[nodiscard]] Report one_step(const Load& load, double dt);
  [[nodiscard]] Report in_parts(const Load& load, double dt, const Report& first);
  /// v = rate (u - u_from), a = rate (v - v_from): what a scheme says of the step's end.
  struct Scheme {
    bool second_order;
    double rate;         // [1/s]
    double now, before;  // u_from = now * u - before * that of the step before; so v_from
    std::vector<double> u_from, v_from;
  };
  [[nodiscard]] Scheme scheme(double dt) const;
  [[nodiscard]] FiniteTarget target(const Load& load, const Scheme& by);
  void add_viscosity(const Scheme& by, FiniteTarget& target);
  [[nodiscard]] bool is_still(const Scheme& by, FiniteTarget& target);
  [[nodiscard]] Report stay(const FiniteTarget& end, const Scheme& by, double dt);
  [[nodiscard]] bool begin(const FiniteTarget& target, double dt);
  [[nodiscard]] bool better_where_it_is(const FiniteTarget& target) const;
  /// False: the device goes by tangents of its own.
  [[nodiscard]] bool needs_base() const;
  [[nodiscard]] const fem::TangentPattern& pattern();
  [[nodiscard]] bool ensure_base(const fem::Inertia& inertia, Report& report);
  [[nodiscard]] bool renew(const std::vector<double>& u, const fem::Inertia& inertia,
                           Report& report);
  [[nodiscard]] bool minimise(const FiniteTarget& target, Report& report);
  [[nodiscard]] bool take_exact(const std::vector<double>& u, const fem::Inertia& inertia,
                                Report& report);
  void take(const FiniteTarget& end, const Scheme& by, double dt, Report& report);
  [[nodiscard]] std::vector<double> velocity_of(const FiniteState& state, const Scheme& by) const;
  [[nodiscard]] FiniteMotionBalance balance(const FiniteTarget& end, const Scheme& by,
                                            std::span<const double> v);
  [[nodiscard]] double won_back(const FiniteMotionBalance& of, std::vector<double>& v) const;
  void stay_within(const FiniteTarget& end, const Scheme& by, std::vector<double>& v,
                   Report& report);
  void renew_if_due(const fem::Inertia& inertia, double dt, Report& report);
  [[nodiscard]] int most_on_a_good_base(double dt) const;
  [[nodiscard]] int steps_of_a_base(double dt);

  FiniteMotionOptions options_;
  RestingBody moving_;
  FinitePotential potential_;
  FiniteMinimiser minimiser_;
  FiniteScale scale_;
  std::optional<fem::TangentPattern> pattern_;  // once a base is made
  std::vector<double> node_mass_, mass_;        // per node, per unknown
  std::vector<double> u_, v_, u_before_, v_before_;
  double time_ = 0;
  double dt_before_ = 0;               // of the last step; 0: the state before it is none to go by
  double rate_ = 0;                    // of its scheme [1/s]
  int euler_ = 1;                      // so many steps of backward Euler are still to come
  std::vector<std::uint8_t> gripped_;  // per unknown
  Eigen::VectorXd load_, reaction_;    // at the state, without gravity; of grips, else 0
  Eigen::VectorXd felt_;               // reaction_ without inertia
  struct {
    Eigen::VectorXd load, reaction, felt;
  } at_end_;  // the same of the step's end that balance() has seen last
  std::vector<double> viscous_;
  double broken_ = 0;  // strain energy that left since the last step
  FiniteMotionBalance sum_;
  std::vector<double> ahead_;
  fem::Viscosity viscosity_;
  bool linear_;  // by law "linear" alone
  FiniteState state_, next_;
  std::unique_ptr<FiniteBase> base_;
  bool parted_ = false;    // a base that is made within a step keeps no inverse
  int until_taken_ = 0;    // steps, of the base that has been asked for
  FiniteRenewal renewal_;  // last: its thread reads pattern_ and mass_
};

}  // namespace sunder::solver
