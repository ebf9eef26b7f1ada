// SPDX-License-Identifier: Apache-2.0
// Runs that a chapter sets side by side, and the pictures and tables that all such chapters have.
#pragma once

#include <string>
#include <vector>

#include "app/reproduce/chapters.hpp"
#include "app/reproduce/figures.hpp"

namespace sunder::app::reproduce {

inline const std::vector<int> kSnapshots = {5, 10, 20, 40};  // fractures, as in the paper's Fig. 4
inline const ChartAxes kPathAxes{"distance along the notch's direction [mm]", "height [mm]"};

struct Model {
  std::string name;
  RunResult run;
};

/// A, and B with either K, of scenes `stem`-a and `stem`-b.
[[nodiscard]] std::vector<Model> run_models(const Laboratory& lab, const std::string& stem);

[[nodiscard]] std::string panel_title(const RunResult& run, const State& state);
/// A row per model, a panel per snapshot.
[[nodiscard]] std::string picture(const std::string& title, const std::vector<Model>& models);

[[nodiscard]] DataTable events_table(const std::string& name, const std::vector<Model>& models);
[[nodiscard]] DataTable path_table(const std::string& name, const std::vector<Model>& models);
[[nodiscard]] std::vector<ChartSeries> path_series(const std::vector<Model>& models);

/// All pulls of a scene [N].
[[nodiscard]] double pull_of(const Laboratory& lab, const std::string& scene);
/// Of those pulls, when something breaks first or, with `growth`, when a crack grows first.
[[nodiscard]] std::optional<double> critical_force(const Laboratory& lab, const std::string& scene,
                                                   const std::vector<std::string>& overrides,
                                                   bool growth);

}  // namespace sunder::app::reproduce
