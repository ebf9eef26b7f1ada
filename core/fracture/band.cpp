// SPDX-License-Identifier: Apache-2.0
#include "fracture/band.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

// All in h (method.md 10).
constexpr double kOnRay = 0.2;        // nodes this close to the ray go to one side together
constexpr double kLabelKept = 1.0;    // labelled nodes this close to the ray keep their label
constexpr double kBehind = 0.5;       // centroids may lie this far behind the tip
constexpr double kNodeBehind = 0.25;  // but one node must lie beyond this
constexpr double kLongestStep = 1.5;  // of one event
constexpr double kShare = 1.0;        // of the local h: one event's advance by toughness
constexpr double kStepMargin = 0.25;  // past the last destroyed centroid
constexpr double kOnLine =
    1e-9;  // rounding: a node behind the tip, on the prolonged ray, has no side

/// Side of a node, 0 on the prolonged ray; none when it is left to the common choice.
std::optional<int> own_side(const Board& board, const Ray& ray, Index node) {
  const double h = board.h();
  const Vec2 x = board.node(node) - ray.origin;
  const double along = x.dot(ray.direction);
  const double offset = x.dot(left_of(ray.direction));
  const double distance = along >= 0 ? std::abs(offset) : x.norm();
  if (distance <= kLabelKept * h) {
    const auto label = ray.crack->side.find(node);
    if (label != ray.crack->side.end()) return label->second * ray.orientation;
  }
  if (distance <= kOnRay * h) return std::nullopt;
  if (std::abs(offset) <= kOnLine * h) return 0;
  return offset > 0 ? 1 : -1;
}

/// A band for each choice of the side of near nodes: [0] right (-1), [1] left (+1).
using TwoBands = std::array<std::vector<BandElement>, 2>;

void sort_into_bands(const Board& board, const Ray& ray, BandElement candidate, TwoBands& bands) {
  bool left = false, right = false, near = false, ahead = false;
  for (Index n : board.mesh().tets[candidate.element]) {
    const auto side = own_side(board, ray, n);
    left = left || side == 1;
    right = right || side == -1;
    near = near || !side;
    const double along = (board.node(n) - ray.origin).dot(ray.direction);
    ahead = ahead || along > -kNodeBehind * board.h();
  }
  if (!ahead) return;
  if (left && (right || near)) bands[0].push_back(candidate);
  if (right && (left || near)) bands[1].push_back(candidate);
}

struct Strength {
  double least_yield = std::numeric_limits<double>::infinity();  // of elements without
  double least_toughness = std::numeric_limits<double>::infinity();
  std::size_t count = 0;
};

Strength strength(const std::vector<BandElement>& band, double h, const ElementView& view) {
  Strength s;
  for (const BandElement& b : band) {
    if (!(b.rho < kLongestStep * h)) continue;
    ++s.count;
    const double yield = view.yield[b.element];
    if (yield > 0) s.least_yield = std::min(s.least_yield, yield);
    const double toughness = view.toughness.of(b.element);
    if (toughness > 0) s.least_toughness = std::min(s.least_toughness, toughness);
  }
  return s;
}

/// The weaker band, then the one with fewer elements, then left.
int choose_near_side(const TwoBands& bands, double h, const ElementView& view) {
  const Strength right = strength(bands[0], h, view), left = strength(bands[1], h, view);
  if (right.least_yield != left.least_yield) return right.least_yield < left.least_yield ? -1 : 1;
  if (right.least_toughness != left.least_toughness)
    return right.least_toughness < left.least_toughness ? -1 : 1;
  return right.count < left.count ? -1 : 1;
}

}  // namespace

int node_side(const Board& board, const Ray& ray, int near_side, Index node) {
  return own_side(board, ray, node).value_or(near_side);
}

// Centroids lie between -h/2 and 1.5 h along the ray, and across it at most one element's size
// from a node that is on the ray's other side or (labelled) within h of it.
BandSearch::BandSearch(const Board& board)
    : board_(board),
      reach_(std::hypot((kLongestStep + kBehind) / 2 * board.h(),
                        board.largest_element() + kLabelKept * board.h())) {
  const std::size_t most = board.most_within(reach_);
  near_.reserve(most);
  for (auto& band : bands_) band.reserve(most);
  band_.elements.reserve(most);
}

const Band& BandSearch::find(const Ray& ray, const ElementView& view) {
  const double h = board_.h();
  const Vec2 middle = ray.origin + (kLongestStep - kBehind) / 2 * h * ray.direction;
  board_.elements_within(middle, reach_, near_);
  for (auto& band : bands_) band.clear();
  for (Index e : near_) {
    const double rho = (board_.centroid(e) - ray.origin).dot(ray.direction);
    if (!(rho > -kBehind * h) || rho > kLongestStep * h || !view.live(e)) continue;
    sort_into_bands(board_, ray, {e, rho}, bands_);
  }
  band_.near_side = choose_near_side(bands_, h, view);
  std::swap(band_.elements, bands_[band_.near_side > 0 ? 1 : 0]);
  std::sort(band_.elements.begin(), band_.elements.end(),
            [](const BandElement& a, const BandElement& b) {
              return a.rho != b.rho ? a.rho < b.rho : a.element < b.element;
            });
  double sum = 0;
  for (const BandElement& b : band_.elements) sum += board_.edge_length(b.element);
  band_.size = band_.elements.empty() ? 0 : sum / static_cast<double>(band_.elements.size());
  return band_;
}

namespace {

/// How far K lets the tip go into an element.
Passed judge(const BandElement& b, double distance, double k, double theta, double share,
             const ElementView& view) {
  const double toughness = view.toughness.of(b.element);
  if (toughness > 0)
    return {b.element, b.rho, k >= toughness ? share : 0, k / toughness, toughness};
  const double yield = view.yield[b.element];
  const double r = yield > 0 ? reach(k, yield, theta) : 0;
  return {b.element, b.rho, r, r / distance};
}

}  // namespace

void walk_band(const Band& band, double h, double k, double theta, const ElementView& view,
               Walk& walk) {
  walk.passed.clear();
  walk.advance = 0;
  double survivor = std::numeric_limits<double>::infinity();  // rho of the first that holds
  const double share = std::clamp(kShare * band.size, kBehind * h, kLongestStep * h);
  for (const BandElement& b : band.elements) {
    const double distance = std::max(b.rho, kBehind * h);
    // What K_c lets go, goes a share of h; the first element even where it lies farther.
    const double by_toughness = walk.passed.empty() ? std::max(share, distance) : share;
    Passed passed = judge(b, distance, k, theta, by_toughness, view);
    const double r = passed.reach;
    if (!(r >= distance)) {
      survivor = b.rho;
      break;
    }
    if (passed.toughness > 0) passed.reach = 0;
    walk.passed.push_back(passed);
    const double step = std::min({r, kLongestStep * h, distance + kStepMargin * h});
    walk.advance = std::max(walk.advance, step);
  }
  if (survivor > 0) walk.advance = std::min(walk.advance, survivor);
}

}  // namespace sunder::fracture
