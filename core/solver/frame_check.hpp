// SPDX-License-Identifier: Apache-2.0
// The promise of a frame at the price of its residual. A full check applies the inverse to the
// residual r = f - K u and takes the stress of what comes out. How much stress a residual of that
// size is worth hardly changes while the base, the loads and the stiffness of the body stay, so
// frames whose load full checks span are judged by their own residual.
#pragma once

#include <optional>

#include "solver/base_check.hpp"
#include "solver/checked_loads.hpp"

namespace sunder::solver {

class FrameCheck {
 public:
  /// `promised`: the estimate of an error vouches for no more than this.
  FrameCheck(const Problem& problem, double promised);

  /// A solution as its check sees it.
  struct Solution {
    double residual = 0;        // |f - K u| over the unknowns that no grip holds [N]
    double largest_u = 0;       // [mm]
    double largest_stress = 0;  // over live elements [MPa]
  };

  /// Takes what a full check said of a solution before refining it: `stress` [MPa] is the largest
  /// of A^-1 (f - K u) over live elements.
  void checked(const Load& load, const Solution& solution, double stress, int bases);
  /// Nothing is known any more: the loads to come are of other grips.
  void forget() { known_.forget(); }
  /// Takes what is known of a base that is new since the last full check.
  void follow(int bases, const BaseCheck& check) { static_cast<void>(known_.follow(bases, check)); }
  /// Whether what this knows is of loads on the same unknowns.
  [[nodiscard]] bool takes(const Load& load) const { return known_.takes(load); }
  /// What full checks let expect of another load; nothing: it is no sum of theirs, or the base is
  /// one that nothing is known of.
  [[nodiscard]] std::optional<CheckedLoads::Sum> expected(const Load& load, int bases) {
    return known_.expected(load, bases);
  }

  /// Energy [N mm] of a defect of the deferred update that needs no refinement.
  [[nodiscard]] double energy_tolerance(const CheckedLoads::Sum& expected) const;
  /// Error estimate of a solution; nothing when the full checks are too long ago, their shares
  /// cancel, or the estimate does not vouch for double precision.
  [[nodiscard]] std::optional<double> error(const CheckedLoads::Sum& expected,
                                            const Solution& solution) const;
  /// An event has changed the body.
  void event() { known_.event(); }

 private:
  double promised_;          // or a tenth of the scene's tolerance
  double stress_of_energy_;  // sqrt of the largest stress^2 per energy over all elements
  CheckedLoads known_;
};

}  // namespace sunder::solver
