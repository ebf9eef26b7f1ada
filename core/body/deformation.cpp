// SPDX-License-Identifier: Apache-2.0
#include "body/deformation.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <optional>

#include "body/element.hpp"

namespace sunder::fem {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

Mat3 small_strain(const Mat3& h) { return (h + h.transpose()) / 2; }

/// Axial vector of the skew part: half the curl of u.
Vec3 half_curl(const Mat3& h) {
  return Vec3(h(2, 1) - h(1, 2), h(0, 2) - h(2, 0), h(1, 0) - h(0, 1)) / 2;
}

/// Mean of the principal strains, and how far at most one lies from it.
struct Spread {
  double mean, most;
};
Spread spread(const Mat3& h) {
  const double mean = h.trace() / 3;
  const double x = h(0, 0) - mean, y = h(1, 1) - mean, z = h(2, 2) - mean;
  const double xy = h(0, 1) + h(1, 0), yz = h(1, 2) + h(2, 1), zx = h(2, 0) + h(0, 2);
  const double squared = x * x + y * y + z * z + (xy * xy + yz * yz + zx * zx) / 2;
  return {mean, std::sqrt(2.0 / 3 * squared)};
}

/// tan(theta/2) as the root of a scalar equation: (cos theta/2, n sin theta/2) is the eigenvector
/// of the largest value l = max tr(R^T F) of Horn's matrix (J. Opt. Soc. Am. A 4, 1987), so that
/// l = tr F + 4 w M^-1 w with M = (l + 1 + tr E) I - 2 E, and n tan(theta/2) = 2 M^-1 w. Newton
/// from l = tr F, which is under the root: the function is concave above its poles, so every step
/// stays under it. |M^-1 w| falls with l, so that each step leaves less than the one before: once
/// that is at most `least` it is enough. Nothing: tr F may lie under a pole.
std::optional<double> half_tangent(const Mat3& h, double least) {
  const Spread of = spread(h);
  const Vec3 w = half_curl(h);
  const double trace = h.trace();
  if (!(2 + trace - (of.mean + of.most) > 0)) return std::nullopt;
  const Mat3 strain = small_strain(h);
  double l = 3 + trace;
  for (int step = 0; step < 50; ++step) {
    const Mat3 m = (l + 1 + trace) * Mat3::Identity() - 2 * strain;
    const Vec3 x = 2 * (m.inverse() * w);
    if (x.squaredNorm() <= least * least) return x.norm();
    const double over = l - (3 + trace + 2 * w.dot(x));
    l -= over / (1 + x.squaredNorm());
    if (std::abs(over) <= 1e-14 * std::abs(l)) return x.norm();
  }
  return std::nullopt;
}

/// The same by all eigenvalues of Horn's matrix.
double half_tangent_by_quaternion(const Mat3& h) {
  const Vec3 w = half_curl(h);
  Eigen::Matrix4d k;
  k(0, 0) = 3 + h.trace();
  k.block<3, 1>(1, 0) = 2 * w;
  k.block<1, 3>(0, 1) = 2 * w.transpose();
  k.block<3, 3>(1, 1) = 2 * small_strain(h) - (1 + h.trace()) * Mat3::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(k);
  const Eigen::Vector4d q = solver.eigenvectors().col(3);
  return q.tail<3>().norm() / std::abs(q[0]);
}

}  // namespace

Mat3 displacement_gradient(const Problem& problem, Index e, std::span<const double> u) {
  const auto corners = corner_displacement(problem.mesh(), e, u);
  return (corners.rightCols<3>().colwise() - corners.col(0)) *
         problem.shape(e).gradient.rightCols<3>().transpose();
}

double principal_strain(const Mat3& h) {
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(small_strain(h), Eigen::EigenvaluesOnly);
  const Vec3& e = solver.eigenvalues();  // ascending
  return -e[0] > e[2] ? e[0] : e[2];
}

double rotation_deg(const Mat3& h, double least) {
  const auto tangent = half_tangent(h, least);
  return 2 * kDegrees * std::atan(tangent ? *tangent : half_tangent_by_quaternion(h));
}

/// With n the axis of R, n F n = n U n and both sin(theta) T = 2 n w and cos(theta) T = tr F - n F
/// n hold for T = tr U - n U n >= 0. So tan(theta) = n w / (1 + (tr E - n E n)/2), where n w <= |w|
/// and n E n is at most the largest principal strain.
DeformationBounds deformation_bounds(const Mat3& h) {
  const Spread of = spread(h);
  return {std::abs(of.mean) + of.most, of.most - of.mean, half_curl(h).squaredNorm(),
          1 + (2 * of.mean - of.most) / 2};
}

double DeformationBounds::rotation_deg() const {
  if (!(cosine > 0)) return 180;  // a smaller n w turns further there
  return kDegrees * std::atan(std::sqrt(half_curl_squared) / cosine);
}

}  // namespace sunder::fem
