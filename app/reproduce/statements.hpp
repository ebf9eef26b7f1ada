// SPDX-License-Identifier: Apache-2.0
// The paper's statements with their verdicts, by the runs of any laboratory: the chapters' own, and
// those of another law.
#pragma once

#include <vector>

#include "app/reproduce/chapters.hpp"
#include "app/reproduce/models.hpp"

namespace sunder::app::reproduce {

/// 1a, 1b, 1c; of A, and B by both K (run_models()).
[[nodiscard]] std::vector<Statement> pulled_statements(const std::vector<Model>& models);
/// 2a, of a board without a notch.
[[nodiscard]] Statement up_then_down(const RunResult& run, const KChoice& k);
/// 2b; `a`: the force at which model A starts to tear.
[[nodiscard]] Statement tears_before_a(const Laboratory& lab, const KChoice& k,
                                       const std::optional<double>& a);
/// 3a and 3b, in elements of this size [mm].
[[nodiscard]] std::vector<Statement> next_rupture_statements(const Laboratory& lab,
                                                             const KChoice& k, double size);
/// 4a, 4b, 4c.
[[nodiscard]] std::vector<Statement> side_statements(const Laboratory& lab, const KChoice& k);
/// 6a.
[[nodiscard]] Statement growth_first(const Laboratory& lab, const KChoice& k);
/// 6b, of scene two-instruments.
[[nodiscard]] Statement several_at_once(const RunResult& run, const KChoice& k);
/// 7a, in elements of this size [mm]; rows for the chapter's table.
[[nodiscard]] Statement final_lengths(const Laboratory& lab, const KChoice& k, double size,
                                      std::vector<std::vector<std::string>>& rows);

/// Elements of the notched boards that gmsh makes [mm].
inline constexpr double kCoarseNotch = 3.939, kPressedNotch = 2.6;

/// Scene notch-b with a notch of that length, in elements of that size [mm].
[[nodiscard]] RunPlan notched(const Laboratory& lab, double size, double length,
                              const std::vector<std::string>& overrides);

}  // namespace sunder::app::reproduce
