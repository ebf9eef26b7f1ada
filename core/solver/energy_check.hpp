// SPDX-License-Identifier: Apache-2.0
// The promise of a condensed frame at the price of what the frame changed. A full check applies the
// inverse to the whole residual. What the base gives wrong is linear in the load: once the loads of
// full checks span a load's direction, their errors bound that of the base. Damage can only spoil
// the solution where it acts, and the energy of what the deferred update lacks there bounds the
// stress that it misses.
#pragma once

#include <cmath>
#include <optional>

#include "solver/base_check.hpp"
#include "solver/checked_loads.hpp"

namespace sunder::solver {

class EnergyCheck {
 public:
  explicit EnergyCheck(const Problem& problem);

  /// Takes what a full check said of a load: its report, the error before it refined the solution,
  /// which is what the factor gives by itself, and what a base that drifts had given beside that
  /// (FrameDevice::mended()). `forces`: Deferred::forces(), 0: unknown; `largest`: the largest
  /// stress over live elements.
  void checked(const Load& load, const SolveReport& report, double unrefined, double mended,
               int bases, double forces, double largest_u, double largest);
  /// What a refinement on the region alone changed stress by, relative, and the energy of what the
  /// deferred update lacked before it; `alone`: of nothing else, since another had come before.
  struct Lack {
    double error = 0, energy = 0;
    bool alone = false;
  };
  /// The same of a solution that was so refined, `unrefined` by the first time.
  void refined(const Load& load, double unrefined, const Lack& last, int bases, double forces,
               double largest_u, double largest);
  /// Whether knowing what such an energy is worth by itself would spare later frames a refinement.
  [[nodiscard]] bool wants_worth(double unrefined, int bases) const;
  /// Nothing is known any more: the loads to come are of other grips.
  void forget();
  /// Takes what is known of a base that is new since the last full check; `factor` and `drifts`:
  /// FrameDevice's.
  void follow(int bases, const BaseCheck& check, int factor, bool drifts);
  /// A base that drifts has come with events laid over it since it was checked, and no frame has
  /// looked yet at what it gives wrong by now.
  [[nodiscard]] bool unseen() const { return unseen_; }
  /// Whether what this knows is of loads on the same unknowns.
  [[nodiscard]] bool takes(const Load& load) const { return known_.takes(load); }
  /// What full checks let expect of another load; nothing: it needs a full check.
  [[nodiscard]] std::optional<CheckedLoads::Sum> expected(const Load& load, int bases) {
    if (bases != worth_base_) worth_ = HUGE_VAL;
    return known_.expected(load, bases);
  }
  /// An event has changed the body.
  void event() {
    known_.event();
    if (worth_events_ > 0 && --worth_events_ == 0) worth_ = HUGE_VAL;
  }

  /// Energy [N mm] of a defect that needs no refinement.
  [[nodiscard]] double energy_tolerance(const CheckedLoads::Sum& expected) const;
  /// What is known of a solution without a full check; nothing when that is needed. `energy`: of
  /// what the deferred update lacked (Deferred::defect_energy).
  [[nodiscard]] std::optional<SolveReport> known(const CheckedLoads::Sum& expected, double energy,
                                                 double forces, double largest_u,
                                                 double largest) const;
  /// The same of a solution whose last refinement on the region alone has changed stress by
  /// `error`, relative: that sees what the base and the update lack beside the factor.
  [[nodiscard]] std::optional<SolveReport> known_refined(const CheckedLoads::Sum& expected,
                                                         double error, double largest_u,
                                                         double largest) const;
  /// As known() where grips are new since the last full check on this base, which said `report` and
  /// found `unrefined` before it refined. What they exert are forces on the region, as those of
  /// damage are: the base gives those wrong by as much, with the same room.
  [[nodiscard]] std::optional<SolveReport> known_by_base(const SolveReport& report,
                                                         double unrefined, double energy,
                                                         double largest_u, double largest) const;

 private:
  [[nodiscard]] bool knows_worth(int bases) const;
  void forget_worth();
  [[nodiscard]] double amplified(const CheckedLoads::Sum& expected, double forces) const;

  const Problem& problem_;
  double stress_of_rounding_;  // of a displacement of 1 mm
  double stress_of_energy_;    // sqrt of the largest stress^2 per energy over all elements
  SolveReport report_;         // of the last full check
  int factor_ = 0;
  double of_factor_ = HUGE_VAL;  // the most that full checks have found it to give wrong
  // Stress [MPa] per root of such an energy, with room, as a refinement on the region has found it;
  // on that base, for so many events more.
  double worth_ = HUGE_VAL;
  int worth_base_ = 0, worth_events_ = 0;
  bool worth_alone_ = false;  // it was found of nothing else
  bool unseen_ = false;
  CheckedLoads known_;
};

}  // namespace sunder::solver
