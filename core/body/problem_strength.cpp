// SPDX-License-Identifier: Apache-2.0
// Strength, which fibres may have another of along than across (method.md "Fibres").
#include <Eigen/Eigenvalues>
#include <cmath>

#include "sunder/interfaces.hpp"
#include "sunder/problem.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder {
namespace {

/// N^1/2, N = a a^T/yield + (I - a a^T)/across.
Mat3 root_of_inverse_strengths(const Vec3& a, double yield, double across) {
  const Mat3 along = a * a.transpose();
  return along / std::sqrt(yield) + (Mat3::Identity() - along) / std::sqrt(across);
}

}  // namespace

double Problem::yield_ratio(Index e, const Voigt& stress, YieldMeasure measure) const {
  if (in_interface(e)) return interfaces_->ratio(e, stress);
  const Material& m = material(e);
  if (m.fibres.empty() || !m.fibres.front().yield_across) {
    return yield_measure(stress, measure) / yield(e);
  }
  Mat3 s = tensor(stress);
  if (measure != YieldMeasure::principal) s -= principal_stresses(stress)[2] * Mat3::Identity();
  const Mat3 root =
      root_of_inverse_strengths(fibre_direction(e, 0), yield(e), *m.fibres.front().yield_across);
  const Mat3 scaled = root * s * root;
  const Eigen::SelfAdjointEigenSolver<Mat3> of(scaled, Eigen::EigenvaluesOnly);
  const double most = of.eigenvalues()[2];
  return measure == YieldMeasure::max_shear ? most / 2 : most;
}

}  // namespace sunder
