// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/field_growth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fracture/field_sif/tangential_stress.hpp"
#include "fracture/kinked_crack.hpp"
#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

void add_findings(const Disturbances& disturbed, const Crack& crack, std::size_t tip,
                  std::vector<Finding>& findings) {
  const auto add = [&](bool found, Finding::Kind kind) {
    if (found) findings.push_back({kind, crack.id, static_cast<int>(tip)});
  };
  add(disturbed.fixed, Finding::Kind::field_fixed);
  add(disturbed.material, Finding::Kind::field_material);
  add(disturbed.damage, Finding::Kind::field_damage);
  add(disturbed.strain, Finding::Kind::field_strain);
  add(disturbed.notch, Finding::Kind::field_notch);
  add(disturbed.coarse && disturbed.left_out, Finding::Kind::field_coarse);
  add(disturbed.coarse && !disturbed.left_out, Finding::Kind::field_split);
}

/// By the largest tangential stress, or, where tissue resists by direction, by the energy.
Turn turn_of(const FieldIntensity& measured, const FieldView& view) {
  const auto [k_1, k_2, k_3] = measured.factors;
  if (view.resistance) {
    return easiest_turn(k_1, k_2, measured.frame.direction, *view.resistance).value_or(Turn{});
  }
  const double theta = tangential_angle(k_1, k_2);
  return {theta, tangential_intensity(k_1, k_2, theta)};
}

}  // namespace

std::optional<double> add_field_terms(FieldIntensityMeter& meter, const Crack& crack,
                                      std::size_t tip, const FieldView& view, SifTerms& terms,
                                      std::vector<Finding>& findings) {
  const FieldIntensity measured = meter.at(crack, tip, view);
  add_findings(measured.disturbed, crack, tip, findings);
  if (measured.disturbed.left_out) {
    terms.field_note = measured.note();
    return std::nullopt;
  }
  const auto [k_1, k_2, k_3] = measured.factors;
  // A piece that only destroyed elements hold may move as far as numbers go.
  if (!std::isfinite(k_1) || !std::isfinite(k_2) || !std::isfinite(k_3)) return std::nullopt;
  if (std::isfinite(measured.j)) terms.j = measured.j;
  terms.field_note = measured.note();
  if (!measured.disturbed.strain) {
    terms.k_1 = k_1;
    terms.k_2 = k_2;
    terms.k_3 = k_3;
  }
  const Turn turn = turn_of(measured, view);
  if (!(turn.intensity > 0)) return std::nullopt;
  double k = turn.intensity;
  if (measured.disturbed.strain) {  // K of small strain has no meaning, the energy has
    if (!terms.j || !(*terms.j > 0)) return std::nullopt;
    k = std::sqrt(*terms.j * measured.material.effective_young());
    if (view.resistance) k *= turn.intensity / std::hypot(std::max(k_1, 0.0), k_2);
  }
  const Vec2& d = crack.tips[tip].direction;
  const double theta = growth_angle(d, turned(measured.frame.direction, turn.theta));
  terms.k_field = k;
  terms.theta_field = theta * 180 / std::numbers::pi;
  return theta;
}

std::optional<TipGrowth> field_growth(FieldIntensityMeter& meter, const Crack& crack,
                                      std::size_t tip, const FieldView& view,
                                      std::vector<Finding>& findings) {
  TipGrowth growth;
  growth.terms.tip = static_cast<int>(tip);
  const auto theta = add_field_terms(meter, crack, tip, view, growth.terms, findings);
  if (!theta) return std::nullopt;
  growth.theta = *theta;
  growth.direction = turned(crack.tips[tip].direction, *theta);
  growth.terms.k = *growth.terms.k_field;
  growth.terms.theta = *growth.terms.theta_field;
  return growth;
}

void add_field_state(FieldIntensityMeter& meter, const Crack& crack, std::size_t tip,
                     const FieldView& view, TipState& state, std::vector<Finding>& findings) {
  SifTerms terms;
  add_field_terms(meter, crack, tip, view, terms, findings);
  state.field_note = terms.field_note;
  state.j = terms.j;
  if (!terms.j) return;
  state.k = terms.k_field.value_or(0.0);
  state.theta = terms.theta_field;
  state.k_1 = terms.k_1;
  state.k_2 = terms.k_2;
  state.k_3 = terms.k_3;
}

}  // namespace sunder::fracture
