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
  Index element = kNone;        ///< the first, of a rupture or a growth
  Vec3 place = Vec3::Zero();    ///< its centroid, undeformed [mm]
};

/// Where the law is linear and all forces grow together, so K and stress are proportional to them:
/// what breaks first under a higher load has ratio r_e/max(rho, h/2) ~ load^2 (sif) or
/// measure/yield ~ load (mss), which tells the load where the ratio is 1. None: nothing breaks
/// under 4,096 times the plan's forces.
///
/// By a law of finite deformation neither is so: loads are tried, each on the body as it was in the
/// beginning, from the linear law's on, a quarter more each; of the least that breaks something and
/// the largest that does not, 2 % apart, the same rule tells what lies between. None: nothing
/// breaks under 2.5 times the linear law's load, twice no equilibrium is found
/// (Laboratory::notes()), or K by the field, which was to drive the tip, ended where strains are
/// too large for it.
[[nodiscard]] std::optional<CriticalLoad> critical_load(const Laboratory& lab, RunPlan plan);

/// The load at which a crack grows first, whatever ruptures elsewhere under less: growth goes
/// before rupture (method.md 11), so that a load high enough always shows it. None: no growth under
/// 4,096 times the plan's forces.
[[nodiscard]] std::optional<CriticalLoad> critical_growth(const Laboratory& lab, RunPlan plan);

/// All forces at once, and at most one event. By another law a body that does not come to rest soon
/// is a failure.
[[nodiscard]] RunPlan one_event(const Laboratory& lab, RunPlan plan);

}  // namespace sunder::app::reproduce
