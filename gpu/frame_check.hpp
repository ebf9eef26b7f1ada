// SPDX-License-Identifier: Apache-2.0
// The promise of a frame (solver.tolerance on the stress error) for less than the estimate costs,
// which applies the whole inverse to the residual f - K u. Two shorter ways, both from numbers that
// the frame computes anyway: the residual's energy bounds the stress that it stands for; and a
// residual that is rounding's, of a kind with one that was estimated, is known by comparison.
#pragma once

#include <optional>

#include "gpu/route.hpp"

namespace sunder::gpu {

class FrameCheck {
 public:
  /// `fp64`: storage precision of the inverse.
  FrameCheck(const Problem& problem, bool fp64);

  /// Stress error that needs no refinement.
  [[nodiscard]] double target() const { return target_; }
  /// Stress error up to which a route is worth keeping: what the precision promises of a damaged
  /// body, or somewhat above what a fresh base came to where that is more.
  [[nodiscard]] double keeps() const { return keeps_; }
  /// A solution of a fresh base has this error, or there is no fresher one.
  void settled(double error);
  /// A multiple of a load whose solution needed no refinement, on the same damage: the solution is
  /// linear in the load, and so its relative error is the same. Empty: it is none.
  [[nodiscard]] std::optional<SolveReport> known(const Load& load) const;
  /// What an energy bound says of a solution whose largest stress is `stress`. Empty: too little.
  [[nodiscard]] std::optional<double> bounded(const Load& load, const EnergyBound& energy,
                                              double stress, int bases) const;

  /// The last solution of this load needed no refinement.
  void checked(const Load& load, const SolveReport& report);
  /// So the estimate said, and what the energy bound was.
  void estimated(const Load& load, double error, const EnergyBound& energy, double stress,
                 int bases);
  /// The body has changed.
  void event() { checked_.reset(); }

 private:
  struct Checked {
    Load load;
    SolveReport report;
  };
  struct Estimated {
    Load load;
    double error = 0;  // that the base leaves by itself
    double noise = 0;  // energy root of its residual by the largest stress
    int bases = 0;
  };

  double tolerance_, of_displacement_, target_, keeps_;
  bool fp64_;
  double stress_of_energy_;
  std::optional<Checked> checked_;
  std::optional<Estimated> estimated_;
};

}  // namespace sunder::gpu
