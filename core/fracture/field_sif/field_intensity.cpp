// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/field_intensity.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fracture/crack_path.hpp"
#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

// A free surface frees the front's surroundings from s33 up to about t/2 away from the front; a
// domain that reaches as far as t/2 sees a board in plane stress, a smaller one plane strain.
constexpr double kThinBoard = 2.0;  // thickness / radius

/// Points of the path from the tip backwards.
std::vector<Vec2> path_from_tip(const Crack& crack, std::size_t tip) {
  std::vector<Vec2> points = crack.path;
  if (orientation(crack, tip) > 0) std::reverse(points.begin(), points.end());
  return points;
}

/// The stretch of the path within `length` behind the tip (its length along the path), as a crack
/// of its own with the same sense.
Crack path_tail(const Crack& crack, std::size_t tip, double length) {
  const std::vector<Vec2> points = path_from_tip(crack, tip);
  Crack tail;
  double passed = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    tail.path.push_back(points[i]);
    if (i + 1 == points.size()) break;
    const Vec2 step = points[i + 1] - points[i];
    if (passed + step.norm() >= length) {
      tail.path.push_back(points[i] + step.normalized() * (length - passed));
      break;
    }
    passed += step.norm();
  }
  std::reverse(tail.path.begin(), tail.path.end());
  return tail;
}

/// Elements make a path of short zigzags; the field a few h away sees its mean direction.
Vec2 mean_direction(const Crack& crack, std::size_t tip, double length) {
  const Crack tail = path_tail(crack, tip, length);
  const Vec2 back =
      tail.path.empty() ? Vec2(Vec2::Zero()) : Vec2(tail.path.back() - tail.path.front());
  return back.norm() > 0 ? Vec2(back.normalized()) : crack.tips[tip].direction;
}

/// Points of the path at equal distances behind the tip, the tip left out; none when the path is
/// shorter than `length`.
std::vector<Vec2> sampled_tail(const Crack& crack, std::size_t tip, double length, int count) {
  const std::vector<Vec2> points = path_from_tip(crack, tip);
  std::vector<Vec2> samples;
  double passed = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec2 step = points[i + 1] - points[i];
    const double size = step.norm();
    for (double next = length / count * static_cast<double>(samples.size() + 1);
         next <= passed + size && static_cast<int>(samples.size()) < count;
         next = length / count * static_cast<double>(samples.size() + 1))
      samples.push_back(points[i] + step * ((next - passed) / size));
    passed += size;
  }
  if (static_cast<int>(samples.size()) < count) samples.clear();
  return samples;
}

/// Direction at the tip of a path that bends smoothly: tangent of the parabola through the tip that
/// fits the path's last R best. Its mean direction over R/2 lags behind by a quarter of R, which on
/// a curved path turns K_I into K_II. None where no parabola fits (a kink, a short path).
std::optional<Vec2> fitted_direction(const Crack& crack, std::size_t tip, double radius, double h) {
  constexpr int kSamples = 12;
  constexpr double kFits = 0.15;  // largest rms distance to the parabola, in h
  const TipFrame frame{crack.tips[tip].position, mean_direction(crack, tip, radius / 2)};
  const auto samples = sampled_tail(crack, tip, radius, kSamples);
  if (samples.empty()) return std::nullopt;
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
  if (!(rms <= kFits * h)) return std::nullopt;
  return Vec2(frame.direction + fit.x() * left_of(frame.direction)).normalized();
}

bool straight(const Crack& tail, const TipFrame& frame, double tolerance) {
  return std::all_of(tail.path.begin(), tail.path.end(),
                     [&](const Vec2& p) { return std::abs(frame.local(p).y()) <= tolerance; });
}

std::string tip_name(const Crack& crack, std::size_t tip) {
  return "the field K of crack " + std::to_string(crack.id) + " at its tip " + std::to_string(tip);
}

void disturb(FieldIntensity& result, const char* word, std::string warning) {
  result.note += (result.note.empty() ? "" : "+") + std::string(word);
  result.warnings.push_back(std::move(warning));
}

bool same(const Material& a, const Material& b) {
  return a.young == b.young && a.poisson == b.poisson;
}

}  // namespace

/// What disturbs a domain: distances [mm] of the nearest element of another material and of the
/// nearest element destroyed by something else than this crack.
struct FieldIntensityMeter::Surroundings {
  double other_material = std::numeric_limits<double>::infinity();
  double other_damage = std::numeric_limits<double>::infinity();
};

FieldIntensityMeter::FieldIntensityMeter(const Problem& problem, const Board& board)
    : problem_(problem),
      board_(board),
      surface_(board),
      builder_(board, surface_),
      own_(problem.mesh().tets.size(), 0) {
  board.plane().e3.cwiseAbs().maxCoeff(&normal_axis_);
}

FieldIntensityMeter::Surroundings FieldIntensityMeter::look_around(const Crack& crack,
                                                                   const Vec2& tip, double radius,
                                                                   const FieldView& view) {
  for (Index e : crack.elements) own_[e] = 1;
  Surroundings found;
  const std::vector<Index> near = board_.elements_within(tip, radius);
  double nearest = std::numeric_limits<double>::infinity();
  const Material* material = nullptr;  // of the nearest live element
  for (Index e : near) {
    const double r = (board_.centroid(e) - tip).norm();
    if (view.destroyed[e]) {
      if (!own_[e]) found.other_damage = std::min(found.other_damage, r);
    } else if (r < nearest) {
      nearest = r;
      material = &problem_.material(e);
    }
  }
  for (Index e : near)
    if (!view.destroyed[e] && !same(problem_.material(e), *material))  // set: e is live
      found.other_material = std::min(found.other_material, (board_.centroid(e) - tip).norm());
  for (Index e : crack.elements) own_[e] = 0;
  return found;
}

FieldIntensity FieldIntensityMeter::at(const Crack& crack, std::size_t tip, const FieldView& view,
                                       std::optional<double> radius) {
  if (radius) return measure(crack, tip, view, *radius, {});
  const double h = board_.h();
  // The other tip of an internal crack stays outside: its field is not this tip's.
  const double most = crack.kind == CrackKind::internal ? crack_length(crack) : kDomainRadius * h;
  const double wanted = std::clamp(most, kSmallestDomainRadius * h, kDomainRadius * h);
  const Surroundings around = look_around(crack, crack.tips[tip].position, wanted, view);
  const double free = std::min(around.other_material, around.other_damage);
  const double chosen = std::clamp(free, kSmallestDomainRadius * h, wanted);
  FieldIntensity result = measure(crack, tip, view, chosen, {});
  if (around.other_material < chosen)
    disturb(result, "material",
            tip_name(crack, tip) +
                " reaches another material: it is that of one body with the mean compliance "
                "around the tip");
  if (around.other_damage < chosen)
    disturb(result, "damage",
            tip_name(crack, tip) +
                " reaches elements destroyed by something else: it is not separated from their "
                "field");
  return result;
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
                                            const std::optional<FrontStretch>& stretch) {
  const Vec2& position = crack.tips[tip].position;
  FieldIntensity result;
  result.radius = radius;
  result.frame = {position, fitted_direction(crack, tip, radius, board_.h())
                                .value_or(mean_direction(crack, tip, radius / 2))};
  const auto part = thin(radius) ? FreeSurface::Part::outline : FreeSurface::Part::all;
  const TipDomain domain = builder_.collect(position, radius, view.destroyed, part, stretch);
  if (domain.elements.empty()) return result;  // nothing left to carry a field
  result.material = tip_material(domain);
  displacement_.resize(domain.nodes.size());
  view.displacement(domain.nodes, displacement_);
  IntegralInput input{problem_, board_,        surface_,    result.frame,
                      domain,   displacement_, view.forces, {}};
  const Crack tail = path_tail(crack, tip, 2 * radius);
  if (!straight(tail, result.frame, 1e-6 * board_.h()))
    input.side = [&](const Vec2& p) { return path_side(tail, p, 0); };
  result.factors = interaction_integral(input, result.material);
  const bool held = std::any_of(domain.nodes.begin(), domain.nodes.end(), [&](Index n) {
    for (int axis = 0; axis < 3; ++axis)
      if (axis != normal_axis_ && problem_.dof(n, axis) == kNone) return true;
    return false;
  });
  if (held)
    disturb(result, "fixed",
            tip_name(crack, tip) + " reaches fixed nodes, whose reactions it leaves out");
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
    compliance += v / problem_.material(e).young;
    poisson += v * problem_.material(e).poisson;
  }
  const auto held = std::count_if(domain.nodes.begin(), domain.nodes.end(),
                                  [&](Index n) { return problem_.dof(n, normal_axis_) == kNone; });
  const bool flat = 2 * static_cast<std::size_t>(held) > domain.nodes.size();
  TipMaterial material;
  material.young = volume / compliance;
  material.poisson = poisson / volume;
  material.constraint = thin(domain.radius) && !flat ? 0 : 1;
  return material;
}

}  // namespace sunder::fracture
