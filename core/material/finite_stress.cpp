// SPDX-License-Identifier: Apache-2.0
#include "material/finite_stress.hpp"

#include <Eigen/LU>

#include "material/singular_values.hpp"

namespace sunder {
namespace {

/// Symmetric part, in Voigt order.
Voigt symmetric(const Mat3& s) {
  Voigt v;
  v << s(0, 0), s(1, 1), s(2, 2), (s(0, 1) + s(1, 0)) / 2, (s(1, 2) + s(2, 1)) / 2,
      (s(2, 0) + s(0, 2)) / 2;
  return v;
}

}  // namespace

Voigt cauchy_stress(const Mat3& p, const Mat3& f) {
  return symmetric(p * f.transpose() / f.determinant());
}

Voigt biot_stress(const Mat3& p, const Mat3& f) {
  return symmetric(polar(f).rotation.transpose() * p);
}

}  // namespace sunder
