// SPDX-License-Identifier: Apache-2.0
#include "fracture/tip_growth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fracture/crack_path.hpp"
#include "fracture/geometry_factor.hpp"
#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

Vec2 mean_position(const Board& board, std::span<const Index> nodes) {
  Vec2 sum = Vec2::Zero();
  for (Index n : nodes) sum += board.node(n);
  return sum / static_cast<double>(nodes.size());
}

/// Remote stress of method.md 5, `field` being the one that the choice asks for; none: no element
/// that counts near any station.
std::optional<InPlane> remote_stress(const RemoteField& field, const Crack& crack, const Vec2& tip,
                                     RemoteStress choice) {
  if (choice == RemoteStress::tip) return field.at(tip);
  return field.along(crack_origin(crack).position, tip);
}

/// e_a: where the expansion alone would lead the crack (method.md 8).
Vec2 expansion_direction(const RemoteField& field, const CrackTip& tip) {
  constexpr double kPerpendicular = 1e-12;
  const auto stress = field.at(tip.position);
  if (!stress) return tip.direction;
  const Vec2 e = left_of(principal(*stress).n1);
  const double forward = e.dot(tip.direction);
  if (std::abs(forward) <= kPerpendicular) return left_of(tip.direction);
  return forward > 0 ? e : Vec2(-e);
}

/// The a of Eq. 3: with crack_length = "tool" the distance to the pressed places while some
/// instrument presses the crack open.
double effective_length(const Crack& crack, const FacePressure& pressure, double tool,
                        CrackLength choice) {
  const bool by_tool = choice == CrackLength::tool && !pressure.pushes.empty();
  return by_tool ? tool : crack_length(crack);
}

double geometry_factor(const Crack& crack, double a, double b) {
  return crack.kind == CrackKind::edge ? edge_factor(a / b) : internal_factor(2 * a / b);
}

}  // namespace

void face_pressure(const Board& board, const Crack& crack, const FractureState& state,
                   std::vector<Finding>& findings, FacePressure& faces) {
  faces.pushes.clear();
  faces.upper = faces.lower = 0;
  faces.upward = upward_normal(crack);
  for (const ActingPress& acting : state.presses) {
    if (acting.press->crack != crack.id || acting.nodes.empty()) continue;
    const bool upper = acting.press->side == CrackSide::upper;
    const Vec3 opening = board.plane().lift_direction(upper ? faces.upward : Vec2(-faces.upward));
    const double pressure = acting.force.dot(opening) / board.plane().thickness();
    if (pressure < 0)
      findings.push_back(
          {Finding::Kind::closing_push, static_cast<int>(acting.instrument), crack.id});
    if (!(pressure > 0)) continue;
    (upper ? faces.upper : faces.lower) += pressure;
    faces.pushes.push_back({pressure, mean_position(board, acting.nodes)});
  }
}

double pressure_distance(const FacePressure& pressure, const Vec2& tip) {
  double weighted = 0, total = 0;
  for (const auto& push : pressure.pushes) {
    weighted += push.pressure * (push.at - tip).norm();
    total += push.pressure;
  }
  return total > 0 ? weighted / total : 0;
}

namespace {

Vec2 one_sided_direction(const FacePressure& pressure) {  // e_c
  return pressure.upper >= pressure.lower ? pressure.upward : Vec2(-pressure.upward);
}

}  // namespace

TipState tip_state(const Board& board, const Crack& crack, std::size_t tip) {
  TipState state;
  state.crack = crack.id;
  state.tip = static_cast<int>(tip);
  state.ended = crack.tips[tip].ended;
  state.position = board.plane().lift(crack.tips[tip].position);
  return state;
}

SifTerms formula_terms(const Board& board, const RemoteField& field, const Crack& crack,
                       std::size_t tip, const FacePressure& pressure, const FractureState& state) {
  const FractureOptions& options = state.problem.scene().fracture;
  const CrackTip& at = crack.tips[tip];
  const Vec2& d = at.direction;
  SifTerms terms;
  terms.tip = static_cast<int>(tip);
  terms.at = at.position;
  terms.d = d;
  terms.e_a = expansion_direction(field, at);
  terms.e_c = one_sided_direction(pressure);

  const double tool = pressure_distance(pressure, at.position);
  const double distance = std::max(tool, board.h() / 2);  // b'
  terms.a = effective_length(crack, pressure, tool, options.crack_length);
  terms.b = board.plane().chord(at.position, d);
  const auto remote = remote_stress(field, crack, at.position, options.sigma0);
  if (remote) {
    const Principal p = principal(*remote);
    const double cos_beta = std::min(std::abs(left_of(d).dot(p.n1)), 1.0);
    terms.sigma0 = p.s1;
    terms.beta = std::acos(cos_beta) * kDegrees;
    terms.k_a =
        expansion_intensity(geometry_factor(crack, terms.a, terms.b), cos_beta, p.s1, terms.a);
  }
  terms.k_b = balanced_intensity(pressure.upper, pressure.lower, distance);
  terms.k_c = one_sided_intensity(pressure.upper, pressure.lower, distance);
  const Vec3 opening = board.plane().lift_direction(terms.e_c);
  const double sign = pressure_sign(opening, state.expansion_resultant);
  terms.k = total_intensity(terms.k_a, terms.k_b, terms.k_c, sign);
  return terms;
}

std::optional<TipGrowth> tip_growth(const Board& board, const RemoteField& field,
                                    const Crack& crack, std::size_t tip,
                                    const FacePressure& pressure, const FractureState& state) {
  TipGrowth growth;
  SifTerms& terms = growth.terms;
  terms = formula_terms(board, field, crack, tip, pressure, state);
  const Vec2& d = terms.d;
  const Vec2 v = terms.k_a * terms.e_a + terms.k_b * d + terms.k_c * terms.e_c;
  if (!(v.norm() > 0)) return std::nullopt;
  growth.theta = growth_angle(d, v);
  growth.direction = turned(d, growth.theta);
  terms.theta = growth.theta * kDegrees;
  terms.k_formula = terms.k;
  terms.theta_formula = terms.theta;
  return growth;
}

}  // namespace sunder::fracture
