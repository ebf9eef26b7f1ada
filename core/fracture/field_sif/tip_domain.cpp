// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/tip_domain.hpp"

#include <algorithm>
#include <cmath>

#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

double stretch_weight(const FrontStretch& stretch, double z) {
  return std::max(1 - std::abs(z - stretch.at) / stretch.width, 0.0);
}

/// Integral of the hat's one side, cut off where the front ends.
double half_hat(double width, double available) {
  const double x = std::clamp(available, 0.0, width);
  return x - x * x / (2 * width);
}

double front_length(const BoardPlane& plane, const std::optional<FrontStretch>& stretch) {
  if (!stretch) return plane.thickness();
  return half_hat(stretch->width, plane.top - stretch->at) +
         half_hat(stretch->width, stretch->at - plane.bottom);
}

}  // namespace

Mat3 TipFrame::axes(const BoardPlane& plane) const {
  Mat3 rows;
  rows.row(0) = plane.lift_direction(direction);
  rows.row(1) = plane.lift_direction(left_of(direction));
  rows.row(2) = plane.e3;
  return rows;
}

double domain_weight(double r, double radius) { return std::clamp(2 * (1 - r / radius), 0.0, 1.0); }

void DomainBuilder::reserve(double radius, TipDomain& domain) {
  const std::size_t most = board_.most_within(radius + board_.largest_element());
  const std::size_t nodes = std::min(4 * most, board_.mesh().nodes.size());
  near_.reserve(most);
  domain.elements.reserve(most);
  domain.corners.reserve(most);
  domain.nodes.reserve(nodes);
  domain.in_mesh.reserve(nodes);
  domain.weight.reserve(nodes);
}

void DomainBuilder::collect(const Vec2& tip, double radius, std::span<const std::uint8_t> destroyed,
                            FreeSurface::Part part, const std::optional<FrontStretch>& stretch,
                            std::span<const std::array<Index, 4>> corners_now, TipDomain& domain) {
  ++round_;
  domain.elements.clear();
  domain.corners.clear();
  domain.nodes.clear();
  domain.in_mesh.clear();
  domain.weight.clear();
  domain.radius = radius;
  domain.front_length = front_length(board_.plane(), stretch);
  // Within this distance all corners have q = 1, unless q varies along the front.
  const double full = stretch ? 0 : std::max(radius / 2 - board_.largest_element(), 0.0);
  board_.elements_within(tip, radius + board_.largest_element(), near_);
  for (Index e : near_) {
    if (destroyed[e]) continue;
    const bool inside = (board_.centroid(e) - tip).squaredNorm() < full * full;
    if (inside && !surface_.touches(e, part)) continue;
    const auto& tet = board_.mesh().tets[e];
    const auto& now = corners_now.empty() ? tet : corners_now[static_cast<std::size_t>(e)];
    const auto last = static_cast<std::size_t>(*std::ranges::max_element(now));
    if (last >= place_.size()) place_.resize(last + 1);
    std::array<Place*, 4> places{};
    double lowest = 1, highest = 0;
    for (int a = 0; a < 4; ++a) {
      places[a] = &place_of(now[a], tet[a], tip, radius, stretch);
      lowest = std::min(lowest, places[a]->weight);
      highest = std::max(highest, places[a]->weight);
    }
    // Neither a gradient nor a surface: nothing to integrate.
    if (!(highest > lowest) && !(highest > 0 && surface_.touches(e, part))) continue;
    std::array<Index, 4> corners{};
    for (int a = 0; a < 4; ++a) {
      if (places[a]->at == kNone) {
        places[a]->at = static_cast<Index>(domain.nodes.size());
        domain.nodes.push_back(now[a]);
        domain.in_mesh.push_back(tet[a]);
        domain.weight.push_back(places[a]->weight);
      }
      corners[a] = places[a]->at;
    }
    domain.elements.push_back(e);
    domain.corners.push_back(corners);
  }
}

DomainBuilder::Place& DomainBuilder::place_of(Index node, Index in_mesh, const Vec2& tip,
                                              double radius,
                                              const std::optional<FrontStretch>& stretch) {
  Place& place = place_[node];
  if (place.round == round_) return place;
  double weight = domain_weight((board_.node(in_mesh) - tip).norm(), radius);
  if (stretch)
    weight *= stretch_weight(*stretch, board_.mesh().nodes[in_mesh].dot(board_.plane().e3));
  place = {round_, kNone, weight};
  return place;
}

}  // namespace sunder::fracture
