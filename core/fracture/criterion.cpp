// SPDX-License-Identifier: Apache-2.0
#include "fracture/criterion.hpp"

#include <array>

#include "fracture/combined.hpp"
#include "fracture/fixed_cracks.hpp"
#include "fracture/split/split_cracks.hpp"
#include "fracture/worst_element.hpp"
#include "sunder/fracture_model.hpp"

namespace sunder {
namespace {

template <class Criterion>
std::unique_ptr<FractureCriterion> make(const Problem& problem) {
  return std::make_unique<Criterion>(problem);
}

template <Cause kCause>
std::unique_ptr<FractureCriterion> make_worst(const Problem& problem) {
  return std::make_unique<fracture::WorstElement>(problem, kCause);
}

constexpr std::array kModels{
    FractureModelRow{.model = FractureModel::none,
                     .name = "none",
                     .make = make<fracture::FixedCracks>,
                     .breaks = false,
                     .keeps_cracks = true,
                     .grows_cracks = false,
                     .pristine = false,
                     .measure = {}},
    FractureModelRow{.model = FractureModel::a,
                     .name = "A",
                     .make = make_worst<Cause::mss>,
                     .breaks = true,
                     .keeps_cracks = false,
                     .grows_cracks = false,
                     .pristine = false,
                     .measure = {}},
    FractureModelRow{.model = FractureModel::b,
                     .name = "B",
                     .make = make<fracture::Combined>,
                     .breaks = true,
                     .keeps_cracks = true,
                     .grows_cracks = true,
                     .pristine = true,
                     .measure = {}},
    FractureModelRow{.model = FractureModel::p,
                     .name = "P",
                     .make = make_worst<Cause::principal>,
                     .breaks = true,
                     .keeps_cracks = false,
                     .grows_cracks = false,
                     .pristine = false,
                     .measure = YieldMeasure::principal},
};

}  // namespace

std::span<const FractureModelRow> fracture_models() { return kModels; }

const FractureModelRow& row_of(FractureModel model) {
  return kModels[static_cast<std::size_t>(model)];
}

YieldMeasure strength_measure(const FractureOptions& options) {
  return row_of(options.model).measure.value_or(options.yield_measure);
}

std::unique_ptr<FractureCriterion> make_criterion(const Problem& problem) {
  if (problem.scene().fracture.crack == CrackWay::split) {
    return std::make_unique<fracture::SplitCracks>(problem);
  }
  return row_of(problem.scene().fracture.model).make(problem);
}

}  // namespace sunder
