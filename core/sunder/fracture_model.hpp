// SPDX-License-Identifier: Apache-2.0
// The fracture models, one row each (core/fracture/criterion.cpp). Whoever needs to know something
// of a model asks its row; nobody compares models.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "sunder/scene.hpp"

namespace sunder {

class FractureCriterion;
class Problem;

struct FractureModelRow {
  FractureModel model;
  const char* name;  ///< in scenes and results
  std::unique_ptr<FractureCriterion> (*make)(const Problem&);
  // What it needs, and what it makes sense to ask of it.
  bool breaks;        ///< elements by itself: needs stress, yield ratios and damage
  bool keeps_cracks;  ///< with a path and two faces, on which instruments press
  bool grows_cracks;  ///< bears them too, and measures K at their tips: takes the body for a board
  bool pristine;      ///< needs the displacement of the intact body
  /// What it compares with yield; none: what the scene's `yield_measure` says.
  std::optional<YieldMeasure> measure;
};

/// In the order of FractureModel.
[[nodiscard]] std::span<const FractureModelRow> fracture_models();

[[nodiscard]] const FractureModelRow& row_of(FractureModel model);

/// What is compared with yield: the model's own measure or the scene's.
[[nodiscard]] YieldMeasure strength_measure(const FractureOptions& options);

}  // namespace sunder
