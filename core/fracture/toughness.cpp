// SPDX-License-Identifier: Apache-2.0
#include "fracture/toughness.hpp"

#include <cmath>

#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

constexpr double kNearTip = 1.5;  // h: as far as a tip goes at once

GivenToughness given(const std::optional<double>& intensity, const std::optional<double>& energy) {
  return {intensity.value_or(0.0), energy.value_or(0.0)};
}

}  // namespace

double ToughnessView::of(Index e) const {
  if (along.empty()) return 0;
  const double squared = along[e].squared(young);
  if (across.empty()) return along[e].intensity > 0 ? along[e].intensity : std::sqrt(squared);
  const double against = across[e].squared(young);
  if (!(against > 0)) return std::sqrt(squared);
  const double slope = normal.dot(fibres[e]);
  return std::sqrt(squared + (against - squared) * slope * slope);
}

Toughness::Toughness(const Problem& problem, const Board& board)
    : problem_(problem), board_(board), along_(problem.mesh().tets.size()) {
  const bool guided = problem.guides_cracks();
  if (guided) {
    across_.resize(along_.size());
    fibres_.resize(along_.size());
    near_.reserve(board.most_within(kNearTip * board.h()));
  }
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Material& material = problem.material(e);
    along_[e] = given(material.toughness, material.energy);
    any_ = any_ || material.tough();
    by_energy_ = by_energy_ || material.energy;
    if (!guided || material.fibres.empty()) continue;
    const Fibres& family = material.fibres.front();
    across_[e] = given(family.toughness_across, family.energy_across);
    fibres_[e] = problem.fibre_direction(e, 0);
  }
}

ToughnessView Toughness::view(double young, const Vec2& direction) const {
  if (!any_) return {};
  return {along_, across_, fibres_, young, board_.plane().lift_direction(left_of(direction))};
}

std::optional<TipResistance> Toughness::around(const Vec2& place, double young,
                                               std::span<const std::uint8_t> destroyed) const {
  if (!by_direction()) return std::nullopt;
  board_.elements_within(place, kNearTip * board_.h(), near_);
  TipResistance mean;
  mean.plane = &board_.plane();
  double volume = 0;
  bool guided = false;
  for (Index e : near_) {
    const double along = along_[e].squared(young);
    if (destroyed[e] || !(along > 0)) continue;
    const double part = problem_.shape(e).volume;
    volume += part;
    mean.along += part * along;
    const double across = across_[e].squared(young);
    if (!(across > 0)) continue;
    guided = true;
    mean.across += part * (across - along) * fibres_[e] * fibres_[e].transpose();
  }
  if (!guided) return std::nullopt;
  mean.along /= volume;
  mean.across /= volume;
  return mean;
}

}  // namespace sunder::fracture
