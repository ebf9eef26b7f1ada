// SPDX-License-Identifier: Apache-2.0
// What field K is at a crack whose faces are the mesh's own: where it is left out, and what the
// place at which the mesh lets the crack end brings into it.
#include <algorithm>
#include <cmath>

#include "fracture/crack_birth.hpp"
#include "fracture/crack_path.hpp"
#include "fracture/field_sif/field_intensity.hpp"

namespace sunder::fracture {
namespace {

// What is taken off K leaves up to .3 of itself behind, more where the notch is shorter
// (tests/core/field_sif/notch_test.cpp).
constexpr double kMostTakenOff = 0.1;
constexpr double kShortest = 1.8;  // a in h

FieldView view_of(std::span<const double> displacement, std::span<const std::uint8_t> destroyed) {
  return {destroyed,
          [displacement](std::span<const Index> nodes, std::span<Vec3> u) {
            for (std::size_t i = 0; i < nodes.size(); ++i)
              u[i] = Eigen::Map<const Vec3>(displacement.data() + 3 * nodes[i]);
          },
          {},
          true};
}

}  // namespace

/// Radius that a domain needs to see the open notch at this tip as a crack. 0: there is none, or
/// the crack has left it a domain behind.
double FieldIntensityMeter::clear_of_notch(const Crack& crack, std::size_t tip) const {
  const Notch* notch = notch_of(crack, tip);
  if (!notch || notch->closed) return 0;
  const double clear = std::max(kDomainOfWidths * notch->width, board_.h());
  const double left = (crack.tips[tip].position - notch->root).norm();
  return left < std::max(kDomainRadius * board_.h(), clear) ? clear : 0;
}

/// Of the domain, where nothing is in its way. The other tip of an internal crack stays outside:
/// its field is not this tip's.
double FieldIntensityMeter::wanted_radius(const Crack& crack, std::size_t tip) const {
  const double h = board_.h();
  const double most = crack.kind == CrackKind::internal ? crack_length(crack) : kDomainRadius * h;
  return std::max(std::clamp(most, kSmallestDomainRadius * h, kDomainRadius * h),
                  clear_of_notch(crack, tip));
}

/// Whether the tip is still where the mesh's own crack ends.
bool FieldIntensityMeter::at_root(const Crack& crack, std::size_t tip) const {
  constexpr double kRounding = 1e-9;  // in h
  const Notch* notch = notch_of(crack, tip);
  return notch && (crack.tips[tip].position - notch->root).norm() <= kRounding * board_.h();
}

bool FieldIntensityMeter::blunt(const Crack& crack, std::size_t tip) const {
  if (!(clear_of_notch(crack, tip) > 0)) return false;
  const CrackTip& at = crack.tips[tip];
  const double b = board_.plane().chord(at.position, at.direction);
  return !sharp_enough(*notch_of(crack, tip), crack_length(crack), b,
                       crack.kind == CrackKind::edge);
}

FieldIntensity FieldIntensityMeter::left_out(const Crack& crack, std::size_t tip,
                                             bool Disturbances::*why) const {
  FieldIntensity nothing;
  nothing.frame = {crack.tips[tip].position, crack.tips[tip].direction};
  nothing.disturbed.*why = true;
  nothing.disturbed.left_out = true;
  return nothing;
}

void FieldIntensityMeter::prepare_shifts() {
  if (notches_.empty()) return;
  const auto& presets = problem_.scene().cracks;
  std::vector<std::uint8_t> destroyed(problem_.mesh().tets.size(), 0);
  for (const auto& elements : problem_.crack_elements())
    for (Index e : elements) destroyed[e] = 1;
  for (std::size_t c = 0; c < presets.size(); ++c) {
    const Crack crack =
        preset_crack(board_, presets[c], static_cast<int>(c), problem_.crack_elements()[c]);
    double width = -1;
    for (std::size_t tip = 0; tip < crack.tips.size(); ++tip)
      if (at_root(crack, tip) && !blunt(crack, tip))
        width = std::max(width, notch_of(crack, tip)->width);
    if (width < 0) continue;
    const auto measure_tip = [&](std::size_t tip, std::span<const double> displacement) {
      ShiftedIntensity seen;
      const FieldView view = view_of(displacement, destroyed);
      seen.factors = measure(crack, tip, view, wanted_radius(crack, tip), {}, &seen.shift).factors;
      return seen;
    };
    per_shift_[c] =
        intensity_per_shift(problem_, board_, crack, board_.h() + width / 2, measure_tip);
  }
}

/// 0 where the tip has left the mesh's crack, or where something else is near.
Vec3 FieldIntensityMeter::shift_of(const Crack& crack, std::size_t tip, const FieldView& view) {
  if (!at_root(crack, tip)) return Vec3::Zero();
  const double radius = wanted_radius(crack, tip);
  if (look_around(crack, crack.tips[tip].position, radius, view).nearest() < radius)
    return Vec3::Zero();
  IntensityFactors shift;
  if (measure(crack, tip, view, radius, {}, &shift).disturbed.fixed) return Vec3::Zero();
  return {shift.k_1, shift.k_2, shift.k_3};
}

/// Takes off K what the tips' shifts bring into it; only says so of a crack of split nodes.
void FieldIntensityMeter::mend(const Crack& crack, std::size_t tip, const FieldView& view,
                               FieldIntensity& measured) {
  if (!at_root(crack, tip) || measured.disturbed.fixed) return;
  const Notch& notch = *notch_of(crack, tip);
  const Eigen::MatrixXd& per_shift = per_shift_[static_cast<std::size_t>(crack.id)];
  Vec3 brought = Vec3::Zero();
  for (std::size_t other = 0; per_shift.size() > 0 && other < crack.tips.size(); ++other)
    brought += per_shift.block<kModes, kModes>(static_cast<Index>(kModes * tip),
                                               static_cast<Index>(kModes * other)) *
               shift_of(crack, other, view);
  auto& [k_1, k_2, k_3] = measured.factors;
  const Vec3 mended = Vec3(k_1, k_2, k_3) - brought;
  const double share = brought.head<2>().norm() / mended.head<2>().norm();
  if (notch.closed) {
    measured.disturbed.coarse = share > kAccuracy;
    return;
  }
  const double a = crack_length(crack);
  if (per_shift.size() == 0 || share > kMostTakenOff || a < kShortest * board_.h())
    measured = left_out(crack, tip, &Disturbances::coarse);
  else if (angle_share(notch, measured.radius, a, mended) > kAccuracy)
    measured = left_out(crack, tip, &Disturbances::notch);
  else
    measured.factors = {mended[0], mended[1], mended[2]};
}

}  // namespace sunder::fracture
