// SPDX-License-Identifier: Apache-2.0
#include "sunder/stress_measures.hpp"

#include <Eigen/Eigenvalues>

namespace sunder {

Mat3 tensor(const Voigt& s) {
  Mat3 t;
  t << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return t;
}

Vec3 principal_stresses(const Voigt& s) {
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.compute(tensor(s), Eigen::EigenvaluesOnly);
  return solver.eigenvalues().reverse();
}

double max_shear(const Voigt& s) {
  const Vec3 p = principal_stresses(s);
  return (p[0] - p[2]) / 2;
}

double yield_measure(const Voigt& s, YieldMeasure measure) {
  if (measure == YieldMeasure::principal) return principal_stresses(s)[0];
  return measure == YieldMeasure::max_shear ? max_shear(s) : 2 * max_shear(s);
}

}  // namespace sunder
