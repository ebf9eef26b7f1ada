// SPDX-License-Identifier: Apache-2.0
#include "body/law_stress.hpp"

#include <cmath>
#include <limits>

#include "material/finite_stress.hpp"
#include "material/linear.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::fem {
namespace {

/// F. From differences to corner 0: a translation costs no accuracy.
Mat3 gradient(const TetShape& shape, const Eigen::Matrix<double, 3, 4>& displacement) {
  const Eigen::Matrix<double, 3, 4> moved = displacement.colwise() - displacement.col(0);
  return Mat3::Identity() + moved * shape.gradient.transpose();
}

Voigt linear_stress(const Problem& problem, Index e,
                    const Eigen::Matrix<double, 3, 4>& displacement) {
  const SmallStrain& law = problem.small_strain(e);
  const Voigt s = stress(problem.shape(e), law, displacement);
  if (!law.fibres) return s;
  const Mat3 f = gradient(problem.shape(e), displacement);
  const Mat3 more = fibre_stress<FibreTheory::linear>(*law.fibres, f);
  Voigt of;
  of << more(0, 0), more(1, 1), more(2, 2), more(0, 1), more(1, 2), more(2, 0);
  return s + of;
}

Voigt stress_by(const Problem& problem, Index e, const Eigen::Matrix<double, 3, 4>& displacement,
                StressMeasure measure) {
  if (problem.material(e).law == MaterialLaw::linear)  // knows but one
    return linear_stress(problem, e, displacement);
  const Mat3 f = gradient(problem.shape(e), displacement);
  const Law& law = law_of(problem, e);
  if (!std::isfinite(law.energy(problem.small_strain(e), f))) {
    return Voigt::Constant(std::numeric_limits<double>::infinity());
  }
  const Mat3 p = law.stress(problem.small_strain(e), f);
  return measure == StressMeasure::biot ? biot_stress(p, f) : cauchy_stress(p, f);
}

}  // namespace

const Law& law_of(const Problem& problem, Index e) {
  return *laws()[static_cast<std::size_t>(problem.material(e).law)];
}

Voigt named_stress(const Problem& problem, Index e,
                   const Eigen::Matrix<double, 3, 4>& displacement) {
  return stress_by(problem, e, displacement,
                   problem.in_interface(e) ? StressMeasure::biot : problem.scene().fracture.stress);
}

Voigt material_stress(const Problem& problem, Index e,
                      const Eigen::Matrix<double, 3, 4>& displacement) {
  return stress_by(problem, e, displacement, StressMeasure::biot);
}

PooledStress pooled_stress(const Problem& problem, Index e, const Mat3& f,
                           const PatchChange& patch) {
  const Law& law = law_of(problem, e);
  const SmallStrain& constants = problem.small_strain(e);
  if (!law.split) return {law.energy(constants, f), law.stress(constants, f)};
  const VolumeSplit::Volume volume = law.split->volume(constants, patch.j);
  return {law.split->shape_energy(constants, f) + volume.energy,
          law.split->shape_stress(constants, f) + volume.pressure * law.split->ratio_slope(f)};
}

Voigt material_stress(const Problem& problem, Index e,
                      const Eigen::Matrix<double, 3, 4>& displacement, const PatchChange& patch) {
  const Mat3 f = gradient(problem.shape(e), displacement);
  if (problem.material(e).law == MaterialLaw::linear) {
    Mat3 h = f - Mat3::Identity();
    h.diagonal().array() += (patch.theta - h.trace()) / 3;
    return stress(problem.small_strain(e), h);
  }
  return biot_stress(pooled_stress(problem, e, f, patch).stress, f);
}

Eigen::Matrix<double, 3, 4> corner_forces(const Problem& problem, Index e,
                                          std::span<const double> u, bool destroyed) {
  const TetShape& shape = problem.shape(e);
  const auto displacement = corner_displacement(problem.mesh(), e, u);
  if (!problem.finite()) {
    const bool nothing = problem.moves() || problem.fibrous();
    const double scale = !destroyed ? 1.0 : nothing ? 0.0 : problem.scene().fracture.alpha;
    const Voigt s = linear_stress(problem, e, displacement);
    return scale * shape.volume * (tensor(s) * shape.gradient).eval();
  }
  if (destroyed) return Eigen::Matrix<double, 3, 4>::Zero();
  const Mat3 p = law_of(problem, e).stress(problem.small_strain(e), gradient(shape, displacement));
  return shape.volume * (p * shape.gradient).eval();
}

Eigen::Matrix<double, 3, 4> corner_forces(const Problem& problem, Index e, const StressField& field,
                                          double share) {
  const TetShape& shape = problem.shape(e);
  return share * shape.volume * (tensor(field.of(e)) * shape.gradient).eval();
}

}  // namespace sunder::fem
