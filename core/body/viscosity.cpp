// SPDX-License-Identifier: Apache-2.0
#include "body/viscosity.hpp"

#include <algorithm>

#include "body/deformation.hpp"
#include "body/pooled_law.hpp"
#include "material/linear.hpp"

namespace sunder::fem {

Viscosity::Viscosity(const HyperelasticBody& body)
    : body_(body), from_(body.problem.mesh().tets.size(), Mat3::Zero()) {}

Mat3 Viscosity::strain(const Mat3& h, Index e) const {
  const Mat3 twice = h + h.transpose();
  return (&body_.law(e) == &kLinear ? twice : Mat3(twice + h.transpose() * h)) / 2;
}

/// Times the volume. Layers of interfaces have none: their strain is an opening over a thickness
/// that is nominal. Where volume is pooled that of shape alone: the element's own change of volume
/// is free, and to slow it would lock the element.
Mat3 Viscosity::stress(const Mat3& strain, double factor, Index e) const {
  if (body_.problem.in_interface(e)) return Mat3::Zero();
  const SmallStrain& law = body_.problem.small_strain(e);
  const double lambda = pools_volume(body_, e) ? -2 * law.mu / 3 : law.lambda;
  Mat3 of = 2 * law.mu * strain;
  of.diagonal().array() += lambda * strain.trace();
  return factor * body_.problem.shape(e).volume * of;
}

void Viscosity::start(std::span<const double> u, double now, std::span<const double> u_before,
                      double before) {
  ++starts_;
  for (Index e = 0; e < body_.problem.tet_count(); ++e) {
    if (!body_.live(e)) continue;
    from_[e] = now * strain(displacement_gradient(body_.problem, e, u), e);
    if (before == 0) continue;
    from_[e] -= before * strain(displacement_gradient(body_.problem, e, u_before), e);
  }
}

double Viscosity::forces(std::span<const double> u, double factor, std::span<double> f) const {
  const Problem& problem = body_.problem;
  std::ranges::fill(f, 0.0);
  double potential = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (!body_.live(e)) continue;
    const Mat3 h = displacement_gradient(problem, e, u), way = strain(h, e) - from_[e];
    Mat3 s = stress(way, factor, e);
    potential += s.cwiseProduct(way).sum() / 2;
    if (&body_.law(e) != &kLinear) s += h * s.eval();  // F times it
    const Eigen::Matrix<double, 3, 4> corners = s * problem.shape(e).gradient;
    for (int a = 0; a < 4; ++a) {
      for (int axis = 0; axis < 3; ++axis) {
        f[3 * problem.mesh().tets[e][a] + axis] += corners(axis, a);
      }
    }
  }
  return potential;
}

ElementMatrix Viscosity::tangent(Index e, std::span<const double> u, double factor) const {
  const Eigen::Matrix<double, 3, 4>& gradient = body_.problem.shape(e).gradient;
  const Mat3 h = displacement_gradient(body_.problem, e, u);
  const bool small = &body_.law(e) == &kLinear;
  const Mat3 f = small ? Mat3::Identity() : Mat3(Mat3::Identity() + h);
  const Mat3 s = small ? Mat3::Zero() : stress(strain(h, e) - from_[e], factor, e);
  ElementMatrix of;
  for (int j = 0; j < 12; ++j) {
    Mat3 turned = Mat3::Zero();  // of F
    turned.row(j % 3) = gradient.col(j / 3).transpose();
    const Mat3 both = f.transpose() * turned;
    const Mat3 p = f * stress((both + both.transpose()) / 2, factor, e) + turned * s;
    Eigen::Map<Eigen::Matrix<double, 3, 4>>(of.col(j).data()) = p * gradient;
  }
  return of;
}

}  // namespace sunder::fem
