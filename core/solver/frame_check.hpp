// SPDX-License-Identifier: Apache-2.0
// The promise of a frame at the price of its residual. A full check applies the inverse to the
// residual r = f - K u and takes the stress of what comes out. How much stress a residual of that
// size is worth hardly changes while the base, the direction of the load and the stiffness of the
// body stay, so frames until then are judged by their own residual.
#pragma once

#include <optional>

#include "solver/base_check.hpp"

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
  void forget() { bases_ = 0; }
  /// Takes what is known of a base that is new since the last full check.
  void follow(int bases, const BaseCheck& check);
  /// The load as a multiple of that of the last full check; nothing: another direction, or a base
  /// that nothing is known of.
  [[nodiscard]] std::optional<double> scale_of(const Load& load, int bases) const;
  [[nodiscard]] bool takes(const Load& load, int bases) const {
    return scale_of(load, bases).has_value();
  }

  /// Energy [N mm] of a defect of the deferred update that needs no refinement.
  [[nodiscard]] double energy_tolerance(double scale) const;
  /// Error estimate of a solution whose load is `scale` times that of the last full check; nothing
  /// when that is too long ago or the estimate does not vouch for double precision.
  [[nodiscard]] std::optional<double> error(double scale, const Solution& solution) const;

 private:
  double promised_;          // or a tenth of the scene's tolerance
  double stress_of_energy_;  // sqrt of the largest stress^2 per energy over all elements
  // Of the last full check:
  Load load_;
  Solution solution_;
  double stress_of_residual_ = 0;  // [MPa/N]
  int bases_ = 0;                  // 0: there was none
};

}  // namespace sunder::solver
