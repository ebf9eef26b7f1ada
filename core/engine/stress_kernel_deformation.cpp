// SPDX-License-Identifier: Apache-2.0
// The largest strain and rotation after a stress pass. Of each group the pass has left bounds; few
// groups pass them, and of those each element is looked at, eight at a time.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/stress_kernel.hpp"
#include "parallel/vectorised.hpp"

namespace sunder::engine {
namespace {

constexpr double kThird = 1.0 / 3;
// A cubic's value beside its largest term, by rounding. Where two principal strains are equal that
// is 3e-8 of them, as fem::principal_strain() has it.
constexpr double kOfCubic = 2e-15;
// Up to so many lanes of a group are looked at one by one.
constexpr int kFewLanes = 2;

/// Whether all roots of x^3 - j2 x - j3, which are real, lie under x.
inline bool over_all_roots(double x, double j2, double j3) {
  const double square = x * x;
  return int{x >= 0} & int{3 * square >= j2} &
         int{x * (square - j2) - j3 >= -kOfCubic * (x * square)};
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

/// Where the largest |E|^2 and |curl u|^2 may be; of those as large the first.
SUNDER_VECTORISED
void StressKernel::largest_bounds(const GroupBounds* groups, std::size_t count, Place& strained,
                                  Place& turned) {
  double strain[kLanes], curl[kLanes], of_strain[kLanes] = {}, of_curl[kLanes] = {};
  std::fill_n(strain, kLanes, -1.0);
  std::fill_n(curl, kLanes, -1.0);
  for (std::size_t g = 0; g < count; ++g) {
    const auto here = static_cast<double>(g);
    for (int l = 0; l < kLanes; ++l) {
      const double up = groups[g].stretch[l], down = groups[g].squeeze[l];
      const double mean = up > down ? up : down;
      const double s = groups[g].deviator[l] + 3 * mean * mean, c = groups[g].curl[l];
      of_strain[l] = s > strain[l] ? here : of_strain[l];
      strain[l] = s > strain[l] ? s : strain[l];
      of_curl[l] = c > curl[l] ? here : of_curl[l];
      curl[l] = c > curl[l] ? c : curl[l];
    }
  }
  int s = 0, c = 0;
  for (int l = 1; l < kLanes; ++l) {
    if (strain[l] > strain[s]) s = l;
    if (curl[l] > curl[c]) c = l;
  }
  strained = {static_cast<std::size_t>(of_strain[s]), s};
  turned = {static_cast<std::size_t>(of_curl[c]), c};
}

/// The bounds of fem::deformation_bounds over the elements of a lane; with d the deviator's share
/// of the largest principal strain, (d^2/q + q)/2 >= d saves a root for all but those that pass.
SUNDER_VECTORISED
std::size_t StressKernel::next_over(const GroupBounds* groups, std::size_t count, std::size_t from,
                                    const DeformationSearch::Limits& limits) {
  const double q = limits.strain / 4, of_square = q > 0 ? 1 / q : 0.0;
  const double strain = limits.strain, compression = limits.compression;
  const double tangent = limits.tangent;
  for (std::size_t g = from; g < count; ++g) {
    const GroupBounds& b = groups[g];
    int any = 0;  // without a branch: nearly all groups have none
    for (int l = 0; l < kLanes; ++l) {
      const double over = strain - b.stretch[l], under = compression - b.squeeze[l];
      const double room = over < under ? over : under;
      const double square = 2 * kThird * b.deviator[l], root = 0.5 * (square * of_square + q);
      const double cosine = 1 - b.squeeze[l] - 0.5 * (root < room ? root : room);
      const double sine = tangent * cosine;
      any |= static_cast<int>(room < 0) | static_cast<int>(square > room * room) |
             static_cast<int>(cosine <= 0) | static_cast<int>(0.75 * b.curl[l] > sine * sine);
    }
    if (any != 0) return g;
  }
  return count;
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
  double d[9][kLanes];  // displacement of corners 1..3 against corner 0
  for (int axis = 0; axis < 3; ++axis) {
    for (int l = 0; l < kLanes; ++l) {
      const double u0 = u[b.corner[0][l] + axis];
      d[axis][l] = u[b.corner[1][l] + axis] - u0;
      d[3 + axis][l] = u[b.corner[2][l] + axis] - u0;
      d[6 + axis][l] = u[b.corner[3][l] + axis] - u0;
    }
  }
  double turned[9];
  for (int i = 0; i < 9; ++i) turned[i] = limits.turned(i / 3, i % 3);
  const double strain = limits.strain, compression = limits.compression;
  const double tangent = limits.tangent, alike = limits.alike_squared;
  double within[kLanes];
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
    const double half_curl_squared = 0.25 * (a * a + c * c + e * e);
    const double cosine = 1 + mean - 0.5 * std::sqrt(4 * kThird * j2), sine = tangent * cosine;
    const int turns_less =
        static_cast<int>(cosine > 0) & static_cast<int>(half_curl_squared <= sine * sine);
    const int all = static_cast<int>(over_all_roots(strain - mean, j2, j3)) &
                    static_cast<int>(over_all_roots(compression + mean, j2, -j3)) &
                    (turns_less | static_cast<int>(apart <= alike));
    within[l] = all != 0 ? 1.0 : 0.0;
  }
  unsigned lanes = 0;
  for (int l = 0; l < kLanes; ++l) lanes |= static_cast<unsigned>(within[l] == 0) << l;
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
  const Vec3 u0(&u[static_cast<std::size_t>(b.corner[0][lane])]);
  Mat3 h = Mat3::Zero();
  for (int corner = 1; corner < 4; ++corner) {
    const Vec3 d = Vec3(&u[static_cast<std::size_t>(b.corner[corner][lane])]) - u0;
    for (int axis = 0; axis < 3; ++axis)
      h.col(axis) += d * b.gradient[3 * (corner - 1) + axis][lane];
  }
  return h;
}

/// Its element that turns furthest, and the one that is strained most.
void StressKernel::preview(DeformationSearch& search, Place at, std::span<const double> u) const {
  Mat3 turned = Mat3::Zero(), strained = turned;
  double curl = 0, strain = 0;
  for (const Block& b : blocks_of(at.group)) {
    if (!counts(b, at.lane)) continue;
    const Mat3 h = gradient_of(b, at.lane, u);
    const fem::DeformationBounds bounds = fem::deformation_bounds(h);
    if (bounds.half_curl_squared > curl) {
      curl = bounds.half_curl_squared;
      turned = h;
    }
    if (bounds.strain > strain) {
      strain = bounds.strain;
      strained = h;
    }
  }
  if (curl > 0) search.preview(turned);
  if (strain > 0) search.preview(strained);
}

void StressKernel::take(DeformationSearch& search, std::size_t group,
                        std::span<const double> u) const {
  const DeformationSearch::Limits limits = search.limits(rounding_);
  const unsigned lanes = lanes_over(groups_[group], limits);
  const bool few = std::popcount(lanes) <= kFewLanes;
  for (const Block& b : blocks_of(group)) {
    const unsigned over = few || lanes == 0 ? lanes : lanes & lanes_over(b, u.data(), limits);
    for (unsigned rest = over; rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      if (counts(b, lane)) search.take(gradient_of(b, lane, u));
    }
  }
}

Deformation StressKernel::deformation(std::span<const double> u) const {
  DeformationSearch search;
  if (groups_.empty()) return search.found();
  // The elements with the largest bounds leave few others to look at.
  Place strained, turned;
  largest_bounds(groups_.data(), groups_.size(), strained, turned);
  preview(search, turned, u);
  preview(search, strained, u);
  std::size_t g = 0;
  while ((g = next_over(groups_.data(), groups_.size(), g, search.limits(rounding_))) <
         groups_.size()) {
    take(search, g++, u);
  }
  return search.found();
}

}  // namespace sunder::engine
