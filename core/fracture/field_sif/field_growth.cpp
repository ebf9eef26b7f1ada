// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/field_growth.hpp"

#include <cmath>
#include <numbers>

#include "fracture/field_sif/tangential_stress.hpp"
#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {

std::optional<TipGrowth> field_growth(FieldIntensityMeter& meter, const Crack& crack,
                                      std::size_t tip, const std::optional<TipGrowth>& formula,
                                      const FractureState& state,
                                      std::vector<std::string>& warnings) {
  const FieldView view{state.destroyed, state.displacement, state.forces()};
  FieldIntensity measured = meter.at(crack, tip, view);
  for (std::string& w : measured.warnings) warnings.push_back(std::move(w));
  const auto [k_1, k_2, k_3] = measured.factors;

  const double from_frame = tangential_angle(k_1, k_2);
  const double k = tangential_intensity(k_1, k_2, from_frame);
  if (!(k > 0) || !std::isfinite(k)) return std::nullopt;
  TipGrowth growth = formula.value_or(TipGrowth{});
  const Vec2& d = crack.tips[tip].direction;
  growth.theta = growth_angle(d, turned(measured.frame.direction, from_frame));
  growth.direction = turned(d, growth.theta);
  growth.terms.tip = static_cast<int>(tip);
  growth.terms.k = k;
  growth.terms.theta = growth.theta * 180 / std::numbers::pi;
  growth.terms.k_1 = k_1;
  growth.terms.k_2 = k_2;
  return growth;
}

}  // namespace sunder::fracture
