// SPDX-License-Identifier: Apache-2.0
// L-BFGS on a base, with a line search on the energy and the estimate of the stress error by which
// it stops (method.md "Finite deformation"). The steps themselves are the device's, where there is
// one and the base is a dense inverse, else the host's.
#pragma once

#include "solver/finite_base.hpp"
#include "solver/finite_potential.hpp"
#include "solver/host_steps.hpp"

namespace sunder::solver {

/// What forces, stresses and energies are measured by.
struct FiniteScale {
  double force = 0;   ///< [N] that acted before; else a body that returns to rest is never there
  double stress = 0;  ///< [MPa] as good as none
  // What rounding leaves of none:
  double force_rounding = 0, stress_rounding = 0, energy_rounding = 0;
};

/// Of a body, whatever acts on it.
[[nodiscard]] FiniteScale finite_scale(const Problem& problem);

class FiniteMinimiser {
 public:
  struct Stop {
    double tolerance;  ///< of stress; 0: only the residual counts
    double residual;
    /// The last step tried, which has shown the state good enough, is taken where it is better yet:
    /// then steps at rest come ever nearer to it.
    bool takes_last = false;
  };
  struct Result {
    bool at_rest = false;
    double residual = 0, error = 0, contraction = 0;
    int back_solves = 0;
  };

  FiniteMinimiser(const FinitePotential& potential, int pairs)
      : potential_(potential), host_(potential, pairs) {}

  void set_scale(const FiniteScale& scale) { scale_ = scale; }
  /// |r| over the forces that act.
  [[nodiscard]] double residual(const FiniteState& state) const;
  /// From an evaluated state, at most so many applications of the base (null: the device needs
  /// none). Not at rest: they did not do, or the energy falls no more; the state is the best one.
  Result minimise(const FiniteTarget& target, FiniteBase* base, const Stop& stop, int most,
                  FiniteState& state);

 private:
  [[nodiscard]] double residual(const FinitePoint& at) const;
  [[nodiscard]] double energy_rounding(const FinitePoint& at) const;
  [[nodiscard]] bool is_better(const FinitePoint& point, const FinitePoint& than) const;
  [[nodiscard]] double stress_error(const FiniteTrial& trial) const;
  [[nodiscard]] bool line_search(FiniteSteps& steps, bool with_stress, const FinitePoint& from,
                                 FiniteTrial& trial) const;
  Result minimise(FiniteSteps& steps, const Stop& stop, int most, FinitePoint at) const;

  const FinitePotential& potential_;
  HostSteps host_;
  FiniteScale scale_;
};

}  // namespace sunder::solver
