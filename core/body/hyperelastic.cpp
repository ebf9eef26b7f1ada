// SPDX-License-Identifier: Apache-2.0
#include "body/hyperelastic.hpp"

#include <algorithm>
#include <cmath>

#include "body/deformation.hpp"
#include "body/law_stress.hpp"
#include "material/linear.hpp"

namespace sunder::fem {
namespace {

// What an eased tangent keeps of negative eigenvalues: with all of them, as near to singular as the
// body is to buckling, an event of the torn board of 7,776 tetrahedra takes 25 back-solves, with
// none 17, with this share 14; of 30,246 6, 8 and 7.
constexpr double kEased = 0.7;

Mat3 deformation_gradient(const HyperelasticBody& body, Index e, std::span<const double> u) {
  return Mat3::Identity() + displacement_gradient(body.problem, e, u);
}

/// Corner forces of a mode of dP: column 3 a + i of the entry (i, j) is dN_a/dX_j.
Eigen::Matrix<double, 12, 9> corner_forces(const TetShape& shape, const Matrix9& modes) {
  Eigen::Matrix<double, 12, 9> w;
  for (int k = 0; k < 9; ++k) {
    const Eigen::Matrix<double, 3, 4> of =
        Eigen::Map<const Mat3>(modes.col(k).data()) * shape.gradient;
    w.col(k) = Eigen::Map<const Eigen::Matrix<double, 12, 1>>(of.data());
  }
  return w;
}

}  // namespace

std::vector<const Law*> laws_of(const Problem& problem) {
  std::vector<const Law*> laws = one_law(problem, kLinear);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    laws[problem.mesh().volume_of[e]] = &law_of(problem, e);
  }
  return laws;
}

std::vector<const Law*> one_law(const Problem& problem, const Law& law) {
  return std::vector<const Law*>(problem.mesh().volumes.size(), &law);
}

double energy(const HyperelasticBody& body, std::span<const double> u) {
  double sum = 0;
  for (Index e = 0; e < body.problem.tet_count(); ++e) {
    if (!body.live(e)) continue;
    sum += body.problem.shape(e).volume *
           body.law(e).energy(body.problem.small_strain(e), deformation_gradient(body, e, u));
  }
  return sum;
}

double internal_forces(const HyperelasticBody& body, std::span<const double> u,
                       std::span<double> f) {
  const Problem& problem = body.problem;
  std::fill(f.begin(), f.end(), 0.0);
  double sum = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (!body.live(e)) continue;
    const Mat3 gradient = deformation_gradient(body, e, u);
    const TetShape& shape = problem.shape(e);
    const double w = body.law(e).energy(problem.small_strain(e), gradient);
    sum += shape.volume * w;
    if (!std::isfinite(w)) continue;
    const Mat3 p = body.law(e).stress(problem.small_strain(e), gradient);
    const Eigen::Matrix<double, 3, 4> force = shape.volume * (p * shape.gradient);
    for (int i = 0; i < 12; ++i)
      f[3 * problem.mesh().tets[e][i / 3] + i % 3] += force(i % 3, i / 3);
  }
  return sum;
}

void element_stresses(const HyperelasticBody& body, std::span<const double> u,
                      StressFunction stress, std::span<Voigt> stresses) {
  std::fill(stresses.begin(), stresses.end(), Voigt::Zero());
  for (Index e = 0; e < body.problem.tet_count(); ++e) {
    if (!body.live(e)) continue;
    const Mat3 f = deformation_gradient(body, e, u);
    const SmallStrain& constants = body.problem.small_strain(e);
    if (!std::isfinite(body.law(e).energy(constants, f))) continue;
    const Mat3 p = body.law(e).stress(constants, f);
    stresses[e] = stress(p, &body.law(e) == &kLinear ? Mat3(Mat3::Identity()) : f);
  }
}

ElementMatrix element_tangent(const HyperelasticBody& body, Index e, std::span<const double> u,
                              Tangent kind) {
  const SpectralTangent tangent =
      body.law(e).tangent(body.problem.small_strain(e), deformation_gradient(body, e, u));
  const TetShape& shape = body.problem.shape(e);
  Vector9 values = shape.volume * tangent.values;
  if (kind != Tangent::exact) {
    const double kept = kind == Tangent::eased ? kEased : 0;
    values = values.cwiseMax(0) + kept * values.cwiseMin(0);
  }
  const auto w = corner_forces(shape, tangent.modes);
  return w * values.asDiagonal() * w.transpose();
}

}  // namespace sunder::fem
