// SPDX-License-Identifier: Apache-2.0
#include "fracture/criterion.hpp"

#include "fracture/combined.hpp"
#include "fracture/fixed_cracks.hpp"
#include "fracture/max_shear.hpp"

namespace sunder {

std::unique_ptr<FractureCriterion> make_criterion(const Problem& problem) {
  switch (problem.scene().fracture.model) {
    case FractureModel::a:
      return std::make_unique<fracture::MaxShear>(problem);
    case FractureModel::b:
      return std::make_unique<fracture::Combined>(problem);
    case FractureModel::none:
      break;
  }
  return std::make_unique<fracture::FixedCracks>(problem);
}

}  // namespace sunder
