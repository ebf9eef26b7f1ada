// SPDX-License-Identifier: Apache-2.0
#include "material/singular_values.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sunder {
namespace {

// Sweeps over the three pairs of columns. Convergence is quadratic: of 300,000 gradients of all
// kinds the worst is off by 1e-5 after three and by rounding after four.
constexpr int kSweeps = 5;
// A column shorter than this has no direction: its square underflows.
constexpr double kNoLength = 1e-150;

/// Turns columns p and q of B, and those of V alike, until they are orthogonal: with t the tangent
/// of the angle, t^2 + t (|q|^2 - |p|^2)/(p.q) = 1, the smaller root.
void make_orthogonal(Mat3& b, Mat3& v, int p, int q) {
  const double twice = 2 * b.col(p).dot(b.col(q));
  const double longer = b.col(q).squaredNorm() - b.col(p).squaredNorm();
  const double below = std::abs(longer) + std::sqrt(longer * longer + twice * twice);
  const double t =
      std::copysign(1.0, longer) * twice / std::max(below, std::numeric_limits<double>::min());
  const double c = 1 / std::sqrt(1 + t * t), s = t * c;
  for (Mat3* m : {&b, &v}) {
    const Vec3 at_p = m->col(p), at_q = m->col(q);
    m->col(p) = c * at_p - s * at_q;
    m->col(q) = s * at_p + c * at_q;
  }
}

/// The longer column first; one changes its sign, so that V stays a rotation.
void sort(Mat3& b, Mat3& v, int p, int q) {
  if (!(b.col(p).squaredNorm() < b.col(q).squaredNorm())) return;
  for (Mat3* m : {&b, &v}) {
    const Vec3 at_p = m->col(p);
    m->col(p) = m->col(q);
    m->col(q) = -at_p;
  }
}

// Newton's iteration for the rotation: of |F|^3 the least determinant that it begins with, and the
// change after which the next one would be rounding, for its error is squared each time.
constexpr double kLeastVolume = 1e-3, kLastChange = 1e-8;
constexpr int kMostNewton = 12;

Vec3 without(const Vec3& x, const Vec3& unit) { return x - unit * unit.dot(x); }

}  // namespace

SingularValues singular_values(const Mat3& f) {
  Mat3 b = f, v = Mat3::Identity();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    make_orthogonal(b, v, 0, 1);
    make_orthogonal(b, v, 1, 2);
    make_orthogonal(b, v, 0, 2);
  }
  sort(b, v, 0, 1);
  sort(b, v, 1, 2);
  sort(b, v, 0, 1);
  const Vec3 length = b.colwise().norm();
  SingularValues of;
  of.u.col(0) = length[0] > kNoLength ? Vec3(b.col(0) / length[0]) : Vec3(v.col(0));
  // Of v1 and v2 at least one lies at 45 degrees or more from u0.
  Vec3 second = without(v.col(1), of.u.col(0));
  if (second.squaredNorm() < 0.5) second = without(v.col(2), of.u.col(0));
  if (length[1] > kNoLength) second = without(b.col(1) / length[1], of.u.col(0));
  of.u.col(1) = second.normalized();
  of.u.col(2) = of.u.col(0).cross(of.u.col(1));
  of.s = Vec3(length[0], length[1], of.u.col(2).dot(b.col(2)));
  of.v = v;
  return of;
}

Polar polar(const Mat3& f) {
  const SingularValues of = singular_values(f);
  return {of.u * of.v.transpose(), of.v * of.s.asDiagonal() * of.v.transpose()};
}

Mat3 nearest_rotation(const Mat3& f) {
  double volume = f.col(0).dot(f.col(1).cross(f.col(2)));
  const double size = f.norm();
  if (volume > kLeastVolume * size * size * size) {
    Mat3 x = f / std::cbrt(volume);
    for (int i = 0; i < kMostNewton; ++i) {
      Mat3 cofactor;
      cofactor << x.col(1).cross(x.col(2)), x.col(2).cross(x.col(0)), x.col(0).cross(x.col(1));
      volume = x.col(0).dot(cofactor.col(0));
      const Mat3 next = 0.5 * (x + cofactor / volume);
      const double change = (next - x).norm();
      x = next;
      if (change < kLastChange) return x;
    }
  }
  return polar(f).rotation;
}

}  // namespace sunder
