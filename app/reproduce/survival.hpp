// SPDX-License-Identifier: Apache-2.0
// What becomes of the paper's statements when elements may turn: verdicts by the linear law and by
// a law of finite deformation, side by side.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/reproduce/study.hpp"

namespace sunder::app::reproduce {

enum class Survival {
  survives,     ///< as good a verdict as by the linear law
  in_part,      ///< "partly" of what was reproduced
  does_not,     ///< not reproduced any more
  ends_before,  ///< a worse verdict, of a run that found no equilibrium
  appears,      ///< by the linear law it does not come out
  with_neither
};
[[nodiscard]] const char* to_string(Survival survival);

/// `ended`: a run of the other law behind the statement found no equilibrium.
[[nodiscard]] Survival survival_of(Verdict linear, Verdict other, bool ended);

/// A statement by two laws, from runs that differ in nothing else.
struct TwoVerdicts {
  Statement linear, other;
  std::vector<RunNote> runs;  ///< of the other law, for this statement
};
[[nodiscard]] Survival survival_of(const TwoVerdicts& both);

/// "no equilibrium beyond 12 N", "the field has no K: ..." or "".
[[nodiscard]] std::string why_not(const TwoVerdicts& both);

/// A row per statement, with all its figures in one cell, "name: linear / other".
[[nodiscard]] DataTable survival_table(std::span<const TwoVerdicts> all);
/// A row per figure.
[[nodiscard]] DataTable figures_table(std::span<const TwoVerdicts> all);
/// "19 of 31 survive: 1a formula K, ...; the run ends before 1: ...".
[[nodiscard]] std::vector<std::string> survival_findings(std::span<const TwoVerdicts> all);

/// Every run by the other law, as it ended.
[[nodiscard]] DataTable runs_table(std::span<const RunNote> notes);

}  // namespace sunder::app::reproduce
