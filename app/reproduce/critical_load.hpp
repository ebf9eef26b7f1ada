// SPDX-License-Identifier: Apache-2.0
// The smallest load at which something breaks first, from one step instead of a search.
#pragma once

#include <optional>

#include "app/reproduce/laboratory.hpp"

namespace sunder::app::reproduce {

struct CriticalLoad {
  double factor = 0;            ///< of the plan's own forces
  Cause cause = Cause::mss;     ///< of the first rupture
  std::optional<SifTerms> sif;  ///< at `factor` times the plan's forces, when a crack grew
  double rise_deg = 0;          ///< of the first growth above the plane's e1, upwards positive
  double h = 0;                 ///< mean edge of the mesh [mm]
};

/// The body is linear and all forces grow together, so K and stress are proportional to them: what
/// breaks first under a higher load has ratio r_e/max(rho, h/2) ~ load^2 (sif) or measure/yield ~
/// load (mss), which tells the load where the ratio is 1. None: nothing breaks under 4,096 times
/// the plan's forces.
[[nodiscard]] std::optional<CriticalLoad> critical_load(const Laboratory& lab, RunPlan plan);

/// The load at which a crack grows first, whatever ruptures elsewhere under less: growth goes
/// before rupture (method.md 11), so that a load high enough always shows it. None: no growth under
/// 4,096 times the plan's forces.
[[nodiscard]] std::optional<CriticalLoad> critical_growth(const Laboratory& lab, RunPlan plan);

}  // namespace sunder::app::reproduce
