// SPDX-License-Identifier: Apache-2.0
#include "body/hyperelastic.hpp"

#include <algorithm>
#include <cmath>

#include "body/deformation.hpp"
#include "body/law_stress.hpp"
#include "body/pooled_law.hpp"
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

/// W, or its part of shape where the volume is the patch's.
double own_energy(const HyperelasticBody& body, Index e, const Mat3& f) {
  const Law& law = body.law(e);
  return (pools_volume(body, e) ? law.split->shape_energy : law.energy)(
      body.problem.small_strain(e), f);
}

/// P, with its patch's pressure where the volume is that.
Mat3 whole_stress(const HyperelasticBody& body, Index e, const Mat3& f,
                  const PatchVolumes& patches) {
  const SmallStrain& constants = body.problem.small_strain(e);
  if (!pools_volume(body, e)) return body.law(e).stress(constants, f);
  const double pressure = patches.pressure()[body.pools()->of(e)];
  const VolumeSplit& split = *body.law(e).split;
  return split.shape_stress(constants, f) + pressure * split.ratio_slope(f);
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
    const Mat3 f = deformation_gradient(body, e, u);
    sum += body.problem.shape(e).volume * own_energy(body, e, f);
  }
  return sum + PatchVolumes(body, u).energy();
}

double internal_forces(const HyperelasticBody& body, std::span<const double> u,
                       std::span<double> f) {
  const Problem& problem = body.problem;
  const PatchVolumes patches(body, u);
  std::fill(f.begin(), f.end(), 0.0);
  double sum = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (!body.live(e)) continue;
    const Mat3 gradient = deformation_gradient(body, e, u);
    const TetShape& shape = problem.shape(e);
    const double w = own_energy(body, e, gradient);
    sum += shape.volume * w;
    if (!std::isfinite(w)) continue;
    const Mat3 p = whole_stress(body, e, gradient, patches);
    const Eigen::Matrix<double, 3, 4> force = shape.volume * (p * shape.gradient);
    for (int i = 0; i < 12; ++i)
      f[3 * problem.mesh().tets[e][i / 3] + i % 3] += force(i % 3, i / 3);
  }
  return sum + patches.energy();
}

void element_stresses(const HyperelasticBody& body, std::span<const double> u,
                      StressFunction stress, std::span<Voigt> stresses) {
  const PatchVolumes patches(body, u);
  std::fill(stresses.begin(), stresses.end(), Voigt::Zero());
  for (Index e = 0; e < body.problem.tet_count(); ++e) {
    if (!body.live(e)) continue;
    const Mat3 f = deformation_gradient(body, e, u);
    if (!std::isfinite(own_energy(body, e, f))) continue;
    const Mat3 p = whole_stress(body, e, f, patches);
    stresses[e] = stress(p, &body.law(e) == &kLinear ? Mat3(Mat3::Identity()) : f);
  }
}

ElementMatrix element_tangent(const HyperelasticBody& body, Index e, std::span<const double> u,
                              Tangent kind, std::span<const double> pressure) {
  const SmallStrain& constants = body.problem.small_strain(e);
  const Mat3 f = deformation_gradient(body, e, u);
  const bool pools = pools_volume(body, e);
  const Index patch = pools ? body.pools()->of(e) : kNone;
  const double of_patch = !pools             ? 0
                          : pressure.empty() ? patch_pressure(body, patch, u)
                                             : pressure[patch];
  const SpectralTangent tangent = pools ? body.law(e).split->shape_tangent(constants, f, of_patch)
                                        : body.law(e).tangent(constants, f);
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
