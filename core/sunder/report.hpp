// SPDX-License-Identifier: Apache-2.0
// What a run tells: one record per destroyed element, one per step.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sunder/backend.hpp"
#include "sunder/crack.hpp"

namespace sunder {

/// parting: by an interface's law, "interface" in results; as a name that is a macro of Windows.
enum class Cause { mss, sif, preset, script, principal, parting };
[[nodiscard]] const char* to_string(Cause cause);

/// One destroyed element, or what a split crack did (a row of events.csv).
struct DestroyedElement {
  int step = 0;
  int event = 0;  ///< over the whole run, from 0
  Index element = kNone;
  /// A crack has split (fracture.crack): nothing is destroyed, `element` is the one that asked for
  /// a new crack, none where one grows.
  bool lives = false;
  Cause cause = Cause::mss;
  int crack = kNone;  ///< for sif, preset, and the mss that starts a crack
  /// mss, principal: measure/yield; sif: r_e / max(rho, h/2) or K / K_c; parting:
  /// traction/strength, in statics times the root of the release that its neighbours showed.
  std::optional<double> ratio;
  double load_factor = 0;  ///< scene time t
  std::optional<SifTerms> sif;
  std::optional<double> energy;  ///< parting: that its law asks for, in this mode [N mm]
  /// The instrument with the largest share of the maximum shear stress of the event's first
  /// element, and that share of the whole (Simulation::attribute_events); kNone: not asked for.
  int instrument = kNone;
  double instrument_share = 0;
};

/// The stages of a frame, in order; milliseconds. Stress that a device computes in one submit with
/// the displacement counts as `solve`.
struct StageTimes {
  double load = 0, solve = 0, stress = 0, decide = 0, update = 0, total = 0;
};

/// One step (a row of frames.csv).
struct StepReport {
  int step = 0;
  double load_factor = 0;
  int events = 0;     ///< of this step
  int destroyed = 0;  ///< total so far
  double compliance = 0;
  double residual = 0;
  double error = 0;
  double max_yield_ratio = 0;  ///< over live breakable elements, at the end of the step
  int iterations = 0;
  int back_solves = 0;      ///< applications of the base, those of conjugate gradients left out
  bool unfinished = false;  ///< not at rest: nothing was decided, the next step goes on from it
  bool polished = false;
  bool capped = false;  ///< in motion: ended by dynamics.max_iterations, its error not promised
  /// Ended by time between two events: what was still to break is left to the next step.
  bool out_of_time = false;
  /// Of this step and of what a host did since the one before: grips, cuts, removals, going back.
  /// None up to as many columns of damage as `plan` tells, and by law linear none for a grip.
  NewBases new_bases;
  StageTimes times;
  /// Device time per pass of all solves and updates of the step; empty without a device clock
  /// (Backend::time_passes).
  std::vector<PassTime> passes;
  /// At the end of the step; nothing: stress was left out.
  std::optional<Deformation> deformation;
  /// At the end of the step; nothing: statics.
  std::optional<MotionState> motion;
};

/// Beyond these a run says that the theory of small strains no longer speaks of it
/// (docs/limits.md).
inline constexpr double kSmallStrain = 0.1, kSmallRotationDeg = 10;

}  // namespace sunder
