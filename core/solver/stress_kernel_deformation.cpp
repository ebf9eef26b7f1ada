// SPDX-License-Identifier: Apache-2.0
// The largest strain and rotation after a stress pass. Of each group the pass has left bounds; few
// groups pass them, and of those each element is looked at, eight at a time.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "machine/compiler.hpp"
#include "solver/stress_kernel.hpp"

namespace sunder::solver {
namespace {

constexpr double kThird = 1.0 / 3;
// A cubic's value beside its largest term, by rounding. Where two principal strains are equal that
// is 3e-8 of them, as fem::principal_strain() has it.
constexpr double kOfCubic = 2e-15;

inline double larger(double a, double b) { return a > b ? a : b; }
inline double smaller(double a, double b) { return a < b ? a : b; }

/// Over 0 unless all roots of x^3 - j2 x - j3, which are real, are at most x.
inline double under_a_root(double x, double j2, double j3) {
  const double square = x * x, cubic = x * (square - j2) - j3;
  return larger(larger(-x, j2 - 3 * square), -kOfCubic * (x * square) - cubic);
}

/// Over 0 where the tangent of a rotation may be over `tangent`, by fem::deformation_bounds: of a
/// mean strain of at least -`squeeze` and a largest principal strain of at most `room` over it.
inline double turns_further(double half_curl_squared, double squeeze, double room, double tangent) {
  const double cosine = 1 - squeeze - 0.5 * room, sine = tangent * cosine;
  return larger(-cosine, half_curl_squared - sine * sine);
}

}  // namespace

void StressKernel::keep_deformation() {
  groups_.assign((blocks_.size() + kGroup - 1) / kGroup, GroupBounds{});
  cut_off_.assign(problem_->mesh().tets.size(), 0);
  // The deviator is taken from stress, whose pressure hides some of its digits.
  double stiffest = 0;
  for (const Block& b : blocks_) {
    for (int l = 0; l < kLanes && b.element[l] != kNone; ++l) {
      stiffest = std::max(stiffest, b.lambda[l] / b.mu[l]);
    }
  }
  rounding_ = 64 * std::numeric_limits<double>::epsilon() * (1 + 2 * stiffest);
}

void StressKernel::cut_off(std::span<const Index> elements) {
  for (Index e : elements) cut_off_[static_cast<std::size_t>(e)] = 1;
}

/// Of |E|^2.
inline double StressKernel::strain_bound(const GroupBounds& of, std::ptrdiff_t lane) {
  const double mean = larger(of.stretch[lane], of.squeeze[lane]);
  return of.deviator[lane] + 3 * (mean * mean);
}

SUNDER_VECTORISED
StressKernel::Largest StressKernel::largest_bounds(const GroupBounds* groups, std::size_t count) {
  Largest all{};
  for (std::size_t g = 0; g < count; ++g) {
    for (int l = 0; l < kLanes; ++l) {
      all.strain[l] = larger(all.strain[l], strain_bound(groups[g], l));
      all.curl[l] = larger(all.curl[l], groups[g].curl[l]);
    }
  }
  return all;
}

/// A lane of a group that has the largest bound.
template <class Bound>
StressKernel::Place StressKernel::place_of(const double (&largest)[kLanes], Bound&& bound) const {
  const auto lane = std::max_element(largest, largest + kLanes) - largest;
  const auto group = std::find_if(groups_.begin(), groups_.end(), [&](const GroupBounds& b) {
    return bound(b, lane) >= largest[lane];
  });
  return {static_cast<std::size_t>(group - groups_.begin()), static_cast<int>(lane)};
}

/// Whether the bounds of a group pass the limits. With d the deviator's share of the largest
/// principal strain, (d^2/q + q)/2 >= d saves a root.
SUNDER_VECTORISED
bool StressKernel::any_over(const GroupBounds* groups, std::size_t count,
                            const DeformationSearch::Limits& limits) {
  const double q = limits.strain / 4, of_square = q > 0 ? 1 / q : 0.0;
  const double strain = limits.strain, compression = limits.compression;
  const double tangent = limits.tangent;
  double over[kLanes] = {};
  for (std::size_t g = 0; g < count; ++g) {
    const GroupBounds& b = groups[g];
    for (int l = 0; l < kLanes; ++l) {
      const double room = smaller(strain - b.stretch[l], compression - b.squeeze[l]);
      const double square = 2 * kThird * b.deviator[l];
      const double strained = larger(-room, square - room * room);
      const double root = smaller(0.5 * (square * of_square + q), room);
      const double turned = turns_further(0.75 * b.curl[l], b.squeeze[l], root, tangent);
      over[l] = larger(over[l], larger(strained, turned));
    }
  }
  double all = 0;
  for (const double lane : over) all = larger(all, lane);
  return all > 0;
}

/// Of several groups at once: nearly all pass nothing.
std::size_t StressKernel::next_over(std::size_t from,
                                    const DeformationSearch::Limits& limits) const {
  constexpr std::size_t kAtOnce = 8;
  for (std::size_t g = from; g < groups_.size(); g += kAtOnce) {
    const std::size_t end = std::min(g + kAtOnce, groups_.size());
    if (!any_over(&groups_[g], end - g, limits)) continue;
    for (std::size_t one = g; one < end; ++one) {
      if (any_over(&groups_[one], 1, limits)) return one;
    }
  }
  return groups_.size();
}

/// The same with the root.
unsigned StressKernel::lanes_over(const GroupBounds& b, const DeformationSearch::Limits& limits) {
  unsigned lanes = 0;
  for (int l = 0; l < kLanes; ++l) {
    const double root = std::sqrt(2 * kThird * b.deviator[l]);
    const double cosine = 1 - b.squeeze[l] - root / 2, sine = limits.tangent * cosine;
    const bool within = b.stretch[l] + root <= limits.strain &&
                        b.squeeze[l] + root <= limits.compression && cosine > 0 &&
                        0.75 * b.curl[l] <= sine * sine;
    lanes |= static_cast<unsigned>(!within) << l;
  }
  return lanes;
}

/// Which of a block's elements have a principal strain or a rotation over the limits; the rotation
/// by its bound, or because grad u is that of the largest one.
SUNDER_VECTORISED
unsigned StressKernel::lanes_over(const Block& b, const double* u,
                                  const DeformationSearch::Limits& limits) {
  double d[9][kLanes];
  b.differences(u, d);
  double turned[9];
  for (int i = 0; i < 9; ++i) turned[i] = limits.turned(i / 3, i % 3);
  const double strain = limits.strain, compression = limits.compression;
  const double tangent = limits.tangent, alike = limits.alike_squared;
  const double q = limits.strain / 4, of_square = q > 0 ? 1 / q : 0.0;
  double over[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    double h[3][3], apart = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        h[i][j] = d[i][l] * b.gradient[j][l] + d[3 + i][l] * b.gradient[3 + j][l] +
                  d[6 + i][l] * b.gradient[6 + j][l];
        const double by = h[i][j] - turned[3 * i + j];
        apart += by * by;
      }
    }
    const double mean = kThird * (h[0][0] + h[1][1] + h[2][2]);
    const double x = h[0][0] - mean, y = h[1][1] - mean, z = h[2][2] - mean;
    const double xy = 0.5 * (h[0][1] + h[1][0]), yz = 0.5 * (h[1][2] + h[2][1]),
                 zx = 0.5 * (h[2][0] + h[0][2]);
    const double j2 = 0.5 * (x * x + y * y + z * z) + (xy * xy + yz * yz + zx * zx);
    const double j3 = x * (y * z - yz * yz) - xy * (xy * z - yz * zx) + zx * (xy * yz - y * zx);
    const double a = h[2][1] - h[1][2], c = h[0][2] - h[2][0], e = h[1][0] - h[0][1];
    const double root = smaller(0.5 * (4 * kThird * j2 * of_square + q), strain - mean);
    const double turns = turns_further(0.25 * (a * a + c * c + e * e), -mean, root, tangent);
    over[l] = larger(
        larger(under_a_root(strain - mean, j2, j3), under_a_root(compression + mean, j2, -j3)),
        smaller(turns, apart - alike));
  }
  unsigned lanes = 0;
  for (int l = 0; l < kLanes; ++l) lanes |= static_cast<unsigned>(over[l] > 0) << l;
  return lanes;
}

std::span<const StressKernel::Block> StressKernel::blocks_of(std::size_t group) const {
  const std::size_t first = group * kGroup;
  return std::span(blocks_).subspan(first, std::min(kGroup, blocks_.size() - first));
}

bool StressKernel::counts(const Block& b, int lane) const {
  const Index e = b.element[lane];
  return e != kNone && b.live[lane] != 0 && !cut_off_[static_cast<std::size_t>(e)];
}

Mat3 StressKernel::gradient_of(const Block& b, int lane, std::span<const double> u) {
  double d[3][3];
  for (int corner = 0; corner < 3; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      d[corner][axis] = u[static_cast<std::size_t>(b.corner[corner + 1][lane] + axis)] -
                        u[static_cast<std::size_t>(b.corner[0][lane] + axis)];
    }
  }
  Mat3 h;
  for (int j = 0; j < 3; ++j) {
    const double x = b.gradient[j][lane], y = b.gradient[3 + j][lane], z = b.gradient[6 + j][lane];
    for (int i = 0; i < 3; ++i) h(i, j) = d[0][i] * x + d[1][i] * y + d[2][i] * z;
  }
  return h;
}

/// grad u of the element with the largest bound; zeros: none counts.
template <class Measure>
Mat3 StressKernel::most_by(Measure&& measure, Place at, std::span<const double> u) const {
  Mat3 most = Mat3::Zero();
  double largest = 0;
  for (const Block& b : blocks_of(at.group)) {
    if (!counts(b, at.lane)) continue;
    const Mat3 h = gradient_of(b, at.lane, u);
    const double here = measure(fem::deformation_bounds(h));
    if (here > largest) {
      largest = here;
      most = h;
    }
  }
  return most;
}

void StressKernel::take(DeformationSearch& search, std::size_t group,
                        std::span<const double> u) const {
  const DeformationSearch::Limits limits = search.limits(rounding_);
  const unsigned lanes = lanes_over(groups_[group], limits);
  if (lanes == 0) return;
  for (const Block& b : blocks_of(group)) {
    for (unsigned rest = lanes & lanes_over(b, u.data(), limits); rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      if (counts(b, lane)) search.take(gradient_of(b, lane, u));
    }
  }
}

Deformation StressKernel::deformation(std::span<const double> u) const {
  DeformationSearch search;
  if (groups_.empty()) return search.found();
  // The elements with the largest bounds leave few others to look at.
  const Largest largest = largest_bounds(groups_.data(), groups_.size());
  const Place turned = place_of(largest.curl, [](const auto& b, auto l) { return b.curl[l]; });
  const Place strained = place_of(largest.strain, strain_bound);
  search.preview_rotation(
      most_by([](const auto& bounds) { return bounds.half_curl_squared; }, turned, u));
  search.preview_strain(most_by([](const auto& bounds) { return bounds.strain; }, strained, u));
  for (std::size_t g = 0;; ++g) {
    g = next_over(g, search.limits(rounding_));
    if (g == groups_.size()) break;
    take(search, g, u);
  }
  return search.found();
}

}  // namespace sunder::solver
