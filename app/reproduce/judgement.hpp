// SPDX-License-Identifier: Apache-2.0
// Verdicts on the paper's statements: pure functions of measured numbers, by rules that are part
// of the verdict's own text.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/reproduce/measures.hpp"

namespace sunder::app::reproduce {

enum class Verdict { reproduced, partly, no };
[[nodiscard]] const char* to_string(Verdict verdict);

struct Figure {
  std::string name;  ///< with its unit
  std::optional<double> value;
};

struct Judgement {
  Verdict verdict = Verdict::no;
  std::string rule;
  std::vector<Figure> numbers;
};

// Numbers that could not be measured (nothing broke, no path) are never "reproduced".

/// Experiment 1: the fractures form one crack.
struct OneCrack {
  std::optional<double> connected;  ///< share of the fractures in the largest piece
  std::optional<double> growth;     ///< share of the fractures that are growth of a crack
};
[[nodiscard]] Judgement judge_one_crack(const OneCrack& measured);

/// Experiment 1: the stress peaks at the crack's tip (`at`: "the tip"; without tips "the nearest
/// destroyed element"). Distances in h, one per snapshot.
[[nodiscard]] Judgement judge_peak_at_tip(std::span<const std::optional<double>> distances,
                                          const std::string& at = "the tip");

/// Experiment 1: the two models destroy different elements (Jaccard overlap of their lists).
[[nodiscard]] Judgement judge_models_differ(std::optional<double> overlap);

/// Experiments 1 and 2, Fig. 5(a): first up, then down. `h`: mean edge of the mesh [mm].
[[nodiscard]] bool goes_up_then_down(const Turns& turns);  ///< however low the top
[[nodiscard]] Judgement judge_up_then_down(const std::optional<Turns>& turns, double h);

/// `lower` should be below `higher`, both critical forces [N] under the names given.
[[nodiscard]] Judgement judge_lower_force(std::optional<double> lower, std::optional<double> higher,
                                          const std::string& first, const std::string& second);

/// Experiment 3: under the same force the next rupture is longer when pressed near the tip [mm].
struct NextRupture {
  std::optional<double> length, reach;  ///< of the first event; its largest r_e (Eq. 1)
};
[[nodiscard]] Judgement judge_goes_further(const NextRupture& near, const NextRupture& far);

/// The final length depends on the preset crack's. Ascending presets [mm].
struct FinalLength {
  double preset = 0;
  std::optional<double> final;
};
[[nodiscard]] Judgement judge_final_length(std::span<const FinalLength> lengths);

/// Rupture progression goes before rupture generation. Numbers of events.
struct Order {
  double growths = 0;     ///< that grow a crack
  double went_first = 0;  ///< of these, while an element away from all cracks stood above yield
  double births = 0;      ///< that start a crack
  double mixed = 0;       ///< that do both
};
[[nodiscard]] Judgement judge_propagation_first(const Order& order);

/// Several instruments tear at several places.
struct Several {
  double grown = 0;    ///< cracks that grew
  double tools = 0;    ///< instruments that are the nearest one to some crack
  double at_once = 0;  ///< events in which several cracks grow
};
[[nodiscard]] Judgement judge_several(const Several& several);

/// Experiment 4: up, straight, down. Angles of the first growth, upwards positive [deg].
struct SideAngles {
  std::optional<double> upper, balanced, under;
};
[[nodiscard]] Judgement judge_sides(const SideAngles& angles);

/// Experiment 4: with the expansion (under face) the stress increases, against it it decreases:
/// critical forces [N] under < none < upper.
struct SideForces {
  std::optional<double> under, none, upper;
};
[[nodiscard]] Judgement judge_side_forces(const SideForces& forces);

/// Experiment 5: `more` takes longer than `less` [ms].
[[nodiscard]] Judgement judge_takes_longer(std::optional<double> more, std::optional<double> less,
                                           const std::string& first, const std::string& second);

/// Experiment 5: all totals [ms] are the same.
[[nodiscard]] Judgement judge_equal_totals(std::span<const Figure> totals);

}  // namespace sunder::app::reproduce
