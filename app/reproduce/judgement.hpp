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

/// Experiment 1: the stress peaks at the crack's tip. Distances in h, one per snapshot.
[[nodiscard]] Judgement judge_peak_at_tip(std::span<const std::optional<double>> distances);

/// Experiment 1: the two models destroy different elements (Jaccard overlap of their lists).
[[nodiscard]] Judgement judge_models_differ(std::optional<double> overlap);

/// Experiment 2: first up, then down.
[[nodiscard]] Judgement judge_up_then_down(const std::optional<Turns>& turns);

/// `lower` should be below `higher`, both critical forces [N] under the names given.
[[nodiscard]] Judgement judge_lower_force(std::optional<double> lower, std::optional<double> higher,
                                          const std::string& first, const std::string& second);

/// Experiment 3: the crack goes further when pressed near its tip. Grown lengths [mm].
[[nodiscard]] Judgement judge_goes_further(std::optional<double> near, std::optional<double> far);

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

}  // namespace sunder::app::reproduce
