// SPDX-License-Identifier: Apache-2.0
#include "body/viscosity.hpp"

#include <algorithm>

#include "body/deformation.hpp"
#include "material/linear.hpp"

namespace sunder::fem {

Viscosity::Viscosity(const HyperelasticBody& body)
    : body_(body), from_(body.problem.mesh().tets.size(), Mat3::Zero()) {}

Mat3 Viscosity::strain(const Mat3& h, Index e) const {
  const Mat3 twice = h + h.transpose();
  return (&body_.law(e) == &kLinear ? twice : Mat3(twice + h.transpose() * h)) / 2;
}

void Viscosity::start(std::span<const double> u, double now, std::span<const double> u_before,
                      double before) {
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
    const SmallStrain& law = problem.small_strain(e);
    const Mat3 h = displacement_gradient(problem, e, u), way = strain(h, e) - from_[e];
    Mat3 stress = 2 * law.mu * way;
    stress.diagonal().array() += law.lambda * way.trace();
    stress *= factor * problem.shape(e).volume;
    potential += stress.cwiseProduct(way).sum() / 2;
    if (&body_.law(e) != &kLinear) stress += h * stress.eval();  // F times it
    const Eigen::Matrix<double, 3, 4> corners = stress * problem.shape(e).gradient;
    for (int a = 0; a < 4; ++a) {
      for (int axis = 0; axis < 3; ++axis) {
        f[3 * problem.mesh().tets[e][a] + axis] += corners(axis, a);
      }
    }
  }
  return potential;
}

}  // namespace sunder::fem
