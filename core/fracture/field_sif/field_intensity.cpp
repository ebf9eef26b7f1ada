// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/field_intensity.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "fracture/crack_path.hpp"
#include "fracture/field_sif/energy_release.hpp"
#include "fracture/field_sif/turned_back.hpp"
#include "fracture/stress_intensity.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/report.hpp"

namespace sunder::fracture {
namespace {

// A free surface frees the front's surroundings from s33 up to about t/2 away from the front; a
// domain that reaches as far as t/2 sees a board in plane stress, a smaller one plane strain.
constexpr double kThinBoard = 2.0;  // thickness / radius

/// The path's points from the tip backwards.
class FromTip {
 public:
  FromTip(const Crack& crack, std::size_t tip)
      : path_(crack.path), forward_(orientation(crack, tip) > 0) {}
  [[nodiscard]] std::size_t size() const { return path_.size(); }
  [[nodiscard]] const Vec2& operator[](std::size_t i) const {
    return path_[forward_ ? path_.size() - 1 - i : i];
  }

 private:
  std::span<const Vec2> path_;
  bool forward_;
};

constexpr int kSamples = 12;
using Samples = std::array<Vec2, kSamples>;

/// Points of the path at equal distances behind the tip, the tip left out; false when the path is
/// shorter than `length`.
bool sample_tail(const FromTip& points, double length, Samples& samples) {
  int count = 0;
  double passed = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec2 step = points[i + 1] - points[i];
    const double size = step.norm();
    for (double next = length / kSamples * (count + 1); next <= passed + size && count < kSamples;
         next = length / kSamples * (count + 1))
      samples[static_cast<std::size_t>(count++)] = points[i] + step * ((next - passed) / size);
    passed += size;
  }
  return count == kSamples;
}

bool straight(std::span<const Vec2> tail, const TipFrame& frame, double tolerance) {
  return std::ranges::all_of(
      tail, [&](const Vec2& p) { return std::abs(frame.local(p).y()) <= tolerance; });
}

bool same(const SmallStrain& a, const SmallStrain& b) {
  return a.young == b.young && a.poisson == b.poisson;
}

}  // namespace

FieldIntensityMeter::FieldIntensityMeter(const Problem& problem, const Board& board)
    : problem_(problem),
      board_(board),
      surface_(board),
      notches_(find_notches(problem, board, surface_)),
      per_shift_(problem.scene().cracks.size()),
      builder_(board, surface_),
      patches_(problem),
      own_(problem.mesh().tets.size(), 0) {
  board.plane().e3.cwiseAbs().maxCoeff(&normal_axis_);
  const FractureOptions& fracture = problem.scene().fracture;
  const bool grows = row_of(fracture.model).grows_cracks;
  // By the formula a notch of the mesh's shape has no K, a crack of split nodes has the field's
  // too.
  const bool of_split_nodes =
      std::ranges::any_of(notches_, [](const Notch& notch) { return notch.closed; });
  if (!grows || fracture.sif == SifSource::field || of_split_nodes) prepare_shifts();
  if (!grows) return;
  double radius = kDomainRadius * board.h();
  for (const Notch& notch : notches_) radius = std::max(radius, kDomainOfWidths * notch.width);
  near_.reserve(board.most_within(radius));
  builder_.reserve(radius, domain_);
  displacement_.reserve(domain_.nodes.capacity());
  // Each of the path's points is there for an element destroyed near it.
  tail_.reserve(board.most_within(2 * radius + 2 * board.h() + board.largest_element()) + 3);
}

std::string_view FieldIntensity::note() const {
  if (disturbed.strain) return "strain";
  if (disturbed.notch) return "notch";
  if (disturbed.coarse) return "coarse";
  constexpr std::array<std::string_view, 16> kNotes{"",
                                                    "fixed",
                                                    "material",
                                                    "fixed+material",
                                                    "damage",
                                                    "fixed+damage",
                                                    "material+damage",
                                                    "fixed+material+damage",
                                                    "closed",
                                                    "fixed+closed",
                                                    "material+closed",
                                                    "fixed+material+closed",
                                                    "damage+closed",
                                                    "fixed+damage+closed",
                                                    "material+damage+closed",
                                                    "fixed+material+damage+closed"};
  return kNotes[(disturbed.fixed ? 1U : 0U) + (disturbed.material ? 2U : 0U) +
                (disturbed.damage ? 4U : 0U) + (disturbed.closed ? 8U : 0U)];
}

std::span<const Vec2> FieldIntensityMeter::path_tail(const Crack& crack, std::size_t tip,
                                                     double length) {
  const FromTip points(crack, tip);
  tail_.clear();
  double passed = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    tail_.push_back(points[i]);
    if (i + 1 == points.size()) break;
    const Vec2 step = points[i + 1] - points[i];
    if (passed + step.norm() >= length) {
      tail_.push_back(points[i] + step.normalized() * (length - passed));
      break;
    }
    passed += step.norm();
  }
  std::reverse(tail_.begin(), tail_.end());
  return tail_;
}

/// Elements make a path of short zigzags; the field a few h away sees its mean direction.
Vec2 FieldIntensityMeter::mean_direction(const Crack& crack, std::size_t tip, double length) {
  const auto tail = path_tail(crack, tip, length);
  const Vec2 back = tail.empty() ? Vec2(Vec2::Zero()) : Vec2(tail.back() - tail.front());
  return back.norm() > 0 ? Vec2(back.normalized()) : crack.tips[tip].direction;
}

/// Direction at the tip of a path that bends smoothly: tangent of the parabola through the tip that
/// fits the path's last R best. Its mean direction over R/2 lags behind by a quarter of R, which on
/// a curved path turns K_I into K_II. None where no parabola fits (a kink, a short path).
std::optional<Vec2> FieldIntensityMeter::fitted_direction(const Crack& crack, std::size_t tip,
                                                          double radius) {
  constexpr double kFits = 0.15;  // largest rms distance to the parabola, in h
  const TipFrame frame{crack.tips[tip].position, mean_direction(crack, tip, radius / 2)};
  Samples samples;
  if (!sample_tail(FromTip(crack, tip), radius, samples)) return std::nullopt;
  Eigen::Matrix<double, kSamples, 2> powers;
  Eigen::Matrix<double, kSamples, 1> offsets;
  for (int k = 0; k < kSamples; ++k) {
    const Vec2 x = frame.local(samples[static_cast<std::size_t>(k)]);
    powers.row(k) << x.x(), x.x() * x.x();
    offsets[k] = x.y();
  }
  const Eigen::Matrix2d normal = powers.transpose() * powers;
  if (!(normal.determinant() > 0)) return std::nullopt;
  const Vec2 fit = normal.inverse() * (powers.transpose() * offsets);
  const double rms = (powers * fit - offsets).norm() / std::sqrt(double{kSamples});
  if (!(rms <= kFits * board_.h())) return std::nullopt;
  return Vec2(frame.direction + fit.x() * left_of(frame.direction)).normalized();
}

FieldIntensityMeter::Surroundings FieldIntensityMeter::look_around(const Crack& crack,
                                                                   const Vec2& tip, double radius,
                                                                   const FieldView& view) {
  for (Index e : crack.elements) own_[e] = 1;
  Surroundings found;
  board_.elements_within(tip, radius, near_);
  double nearest = std::numeric_limits<double>::infinity();
  const SmallStrain* material = nullptr;  // of the nearest live element
  for (Index e : near_) {
    const double r = (board_.centroid(e) - tip).norm();
    if (view.destroyed[e]) {
      if (!own_[e]) found.other_damage = std::min(found.other_damage, r);
    } else if (r < nearest) {
      nearest = r;
      material = &problem_.small_strain(e);
    }
  }
  for (Index e : near_)
    if (!view.destroyed[e] && !same(problem_.small_strain(e), *material))  // set: e is live
      found.other_material = std::min(found.other_material, (board_.centroid(e) - tip).norm());
  for (Index e : crack.elements) own_[e] = 0;
  return found;
}

const Notch* FieldIntensityMeter::notch_of(const Crack& crack, std::size_t tip) const {
  const auto found = std::ranges::find_if(notches_, [&](const Notch& notch) {
    return notch.crack == crack.id && notch.tip == static_cast<int>(tip);
  });
  return found == notches_.end() ? nullptr : &*found;
}

FieldIntensity FieldIntensityMeter::at(const Crack& crack, std::size_t tip, const FieldView& view,
                                       std::optional<double> radius) {
  if (radius) return measure(crack, tip, view, *radius);
  if (blunt(crack, tip)) return left_out(crack, tip, &Disturbances::notch);
  const double wanted = wanted_radius(crack, tip);
  const Surroundings around = look_around(crack, crack.tips[tip].position, wanted, view);
  const double chosen = chosen_radius(crack, tip, around);
  if (chosen < clear_of_notch(crack, tip)) return left_out(crack, tip, &Disturbances::notch);
  FieldIntensity result = measure(crack, tip, view, chosen);
  if (result.disturbed.left_out) return result;
  result.disturbed.material = around.other_material < chosen;
  result.disturbed.damage = around.other_damage < chosen;
  if (chosen == wanted && !result.disturbed.strain) mend(crack, tip, view, result);
  if (!result.disturbed.strain) close(view.lips, result);
  return result;
}

/// Lips that press on each other, or would have to, show no K_I: what slides is left of K and J.
void FieldIntensityMeter::close(FieldView::Lips lips, FieldIntensity& measured) {
  IntensityFactors& k = measured.factors;
  using Lips = FieldView::Lips;
  if (lips == Lips::unknown || (lips == Lips::free && !(k.k_1 < 0))) return;
  measured.disturbed.closed = true;
  k.k_1 = 0;
  measured.j = k.k_2 * k.k_2 / measured.material.effective_young() +
               k.k_3 * k.k_3 / (2 * measured.material.shear());
}

double FieldIntensityMeter::chosen_radius(const Crack& crack, std::size_t tip,
                                          const Surroundings& around) const {
  return std::clamp(around.nearest(), kSmallestDomainRadius * board_.h(),
                    wanted_radius(crack, tip));
}

TipMaterial FieldIntensityMeter::material_at(const Crack& crack, std::size_t tip,
                                             const FieldView& view) {
  const Vec2& position = crack.tips[tip].position;
  const Surroundings around = look_around(crack, position, wanted_radius(crack, tip), view);
  collect(position, chosen_radius(crack, tip, around), view);
  return domain_.elements.empty() ? TipMaterial{} : tip_material(domain_);
}

void FieldIntensityMeter::collect(const Vec2& tip, double radius, const FieldView& view,
                                  const std::optional<FrontStretch>& stretch) {
  const auto part = thin(radius) ? FreeSurface::Part::outline : FreeSurface::Part::all;
  builder_.collect(tip, radius, view.destroyed, part, stretch, view.corners, domain_);
}

std::vector<FieldIntensity> FieldIntensityMeter::along_front(const Crack& crack, std::size_t tip,
                                                             const FieldView& view, int stations) {
  const double width = board_.plane().thickness() / (stations - 1);
  std::vector<FieldIntensity> profile;
  for (int k = 0; k < stations; ++k)
    profile.push_back(measure(crack, tip, view, kDomainRadius * board_.h(),
                              FrontStretch{board_.plane().bottom + k * width, width}));
  return profile;
}

FieldIntensity FieldIntensityMeter::measure(const Crack& crack, std::size_t tip,
                                            const FieldView& view, double radius,
                                            const std::optional<FrontStretch>& stretch,
                                            IntensityFactors* shift) {
  const Vec2& position = crack.tips[tip].position;
  FieldIntensity result;
  result.radius = radius;
  result.frame = {
      position,
      fitted_direction(crack, tip, radius).value_or(mean_direction(crack, tip, radius / 2))};
  collect(position, radius, view, stretch);
  const TipDomain& domain = domain_;
  if (domain.elements.empty()) return result;  // nothing left to carry a field
  result.material = tip_material(domain);
  displacement_.resize(domain.nodes.size());
  view.displacement(domain.nodes, displacement_);
  IntegralInput input{problem_,      board_,      surface_, result.frame, domain,
                      displacement_, view.forces, {},       crack.id};
  Mat3 turned = Mat3::Identity();
  if (problem_.finite() && !view.small) {
    const TurnedBack back = turn_back(problem_, domain, displacement_);
    if (!(back.strain <= kSmallStrain && back.rotation_deg <= kSmallRotationDeg))
      result.disturbed.strain = true;
    turned_forces_.assign(view.forces.begin(), view.forces.end());
    for (NodalForce& at : turned_forces_) at.force = back.rotation.transpose() * at.force;
    input.forces = turned_forces_;
    turned = back.rotation;
  }
  patches_.read(domain.elements, {view.destroyed, view.displacement, view.corners, view.pools},
                turned);
  input.patches = patches_.of_elements();
  const auto tail = path_tail(crack, tip, 2 * radius);
  if (!straight(tail, result.frame, 1e-6 * board_.h())) input.bent_path = tail;
  const TipIntegrals found = interaction_integral(input, result.material);
  result.factors = found.factors;
  if (!stretch) result.j = problem_.finite() ? energy_release(input) : found.energy_release;
  if (shift) *shift = shift_integral(input, result.material);
  result.disturbed.fixed = std::ranges::any_of(domain.in_mesh, [&](Index n) {
    for (int axis = 0; axis < 3; ++axis)
      if (axis != normal_axis_ && problem_.dof(n, axis) == kNone) return true;
    return false;
  });
  return result;
}

bool FieldIntensityMeter::thin(double radius) const {
  return board_.plane().thickness() <= kThinBoard * radius;
}

TipMaterial FieldIntensityMeter::tip_material(const TipDomain& domain) const {
  // Of two materials the mean compliance counts: G = K^2 (1/E1 + 1/E2)/2 on their interface.
  double volume = 0, compliance = 0, poisson = 0;
  for (Index e : domain.elements) {
    const double v = problem_.shape(e).volume;
    volume += v;
    compliance += v / problem_.small_strain(e).young;
    poisson += v * problem_.small_strain(e).poisson;
  }
  // Faces that are held flat make plane strain of a thin board.
  std::size_t held = 0, faces = 0;
  for (Index n : domain.in_mesh) {
    if (!board_.on_bottom(n) && !board_.on_top(n)) continue;
    ++faces;
    held += problem_.dof(n, normal_axis_) == kNone;
  }
  const bool flat = 2 * held > faces;
  TipMaterial material;
  material.young = volume / compliance;
  material.poisson = poisson / volume;
  material.constraint = thin(domain.radius) && !flat ? 0 : 1;
  return material;
}

}  // namespace sunder::fracture
