// SPDX-License-Identifier: Apache-2.0
// The promise of a condensed frame at the price of what the frame changed. A full check applies the
// inverse to the whole residual. While the base and the direction of the load stay, damage can only
// spoil the solution where it acts, and the energy of what the deferred update lacks there bounds
// the stress that it misses.
#pragma once

#include <optional>
#include <span>

#include "cpu_reference/routes.hpp"

namespace sunder::cpu_reference {

class EnergyCheck {
 public:
  explicit EnergyCheck(const Problem& problem);

  /// Takes what a full check said of a load, and the error before it refined the solution: that is
  /// what the base gives by itself. `largest`: the largest stress over live elements.
  void checked(const Load& load, const SolveReport& report, double unrefined, int bases,
               double largest_u, double largest);
  /// The load in the direction of the last full check, as a multiple of it.
  [[nodiscard]] std::optional<double> scale_of(const Load& load, const InverseRoute& route) const;
  /// An event has changed the body.
  void event() { changed_ = true; }

  /// Energy [N mm] of a defect that needs no refinement.
  [[nodiscard]] double enough(double scale) const;
  /// What is known of a solution without a full check; nothing when that is needed.
  [[nodiscard]] std::optional<SolveReport> known(double scale, const InverseRoute& route,
                                                 double largest_u, double largest);

 private:
  const Problem& problem_;
  double stress_of_energy_;  // sqrt of the largest stress^2 per energy over all elements
  Load load_;                // of the last full check
  SolveReport report_;       // of it
  double unrefined_ = 0;     // error of the base by itself
  double largest_u_ = 0, largest_ = 0;
  int bases_ = 0;        // of the last full check; 0: there was none
  bool changed_ = true;  // since last_
  SolveReport last_;     // of the last frame
};

}  // namespace sunder::cpu_reference
