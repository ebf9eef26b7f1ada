// SPDX-License-Identifier: Apache-2.0
// Everything that a run has to tell, gathered for the result files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/output/state.hpp"

namespace sunder::app {

/// The frame in which the first element ruptured by a criterion, before it did.
struct RuptureState {
  double displacement_max = 0;  ///< [mm], of nodes that a live element holds
  std::optional<Deformation> deformation;
};

struct RunRecord {
  explicit RunRecord(const Problem& p) : problem(p), last(undeformed(p)) {}

  const Problem& problem;
  BackendInfo backend;
  std::optional<PreparationReport> preparation;  ///< of predicted fractures, where there was one
  std::vector<std::string> left_out;
  std::vector<StepReport> steps;            ///< those that are done
  std::optional<StepReport> unfinished;     ///< the step in which the run was interrupted
  std::vector<DestroyedElement> destroyed;  ///< and what split, rows of events.csv
  std::vector<Crack> cracks;
  std::vector<std::string> warnings;
  State last;  ///< after the last of them
  bool interrupted = false;
  std::optional<std::string> failure;  ///< of a run that could not go on

  std::optional<RuptureState> at_first_rupture;

  [[nodiscard]] int event_count() const;
  /// Elements that are gone: those of split cracks live.
  [[nodiscard]] int destroyed_count() const;
  /// The farthest of all steps and of the first rupture; nothing: stress was left out.
  [[nodiscard]] std::optional<Deformation> largest() const;
  /// Volume of the elements destroyed since the start, presets not counted [mm^3].
  [[nodiscard]] double volume_lost() const;
  /// The report that belongs to `last`; zeros before the first.
  [[nodiscard]] StepReport last_report() const;
  /// First rupture by a criterion, or null.
  [[nodiscard]] const DestroyedElement* first_rupture() const;
};

/// Of one stage over all steps [ms].
struct TimeStatistics {
  double min = 0, median = 0, p99 = 0, max = 0, sum = 0;
};

struct Stage {
  const char* name;
  double StageTimes::*time;
};
/// The stages of a frame in order, the total last.
[[nodiscard]] const std::vector<Stage>& stages();

/// Median: mean of the middle two for an even count; p99: nearest rank.
[[nodiscard]] TimeStatistics statistics(std::vector<double> milliseconds);
[[nodiscard]] TimeStatistics statistics(const std::vector<StepReport>& steps, const Stage& stage);

/// Whether cracks of a scene open faces and destroy nothing.
[[nodiscard]] bool cracks_split(const Scene& scene);

/// "sif, crack 0, tip 1"; "mss, element 12": what broke first, say.
[[nodiscard]] std::string what_broke(const DestroyedElement& row);

[[nodiscard]] const char* name_of(FractureModel model);
[[nodiscard]] const char* name_of(CrackKind kind);

}  // namespace sunder::app
