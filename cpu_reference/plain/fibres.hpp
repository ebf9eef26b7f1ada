// SPDX-License-Identifier: Apache-2.0
// What fibres of an element add to its law, from the definitions, in extended precision. Of law
// "linear" that is the elasticity of five constants in the fibre's own axes, by inverting its
// compliance, less that of its matrix alone.
#pragma once

#include <vector>

#include "cpu_reference/plain/element.hpp"
#include "sunder/problem.hpp"

namespace sunder::plain {

class Fibres {
 public:
  Fibres(const Problem& problem, Index e, const Element& element);
  [[nodiscard]] Real energy(const Real3x3& f) const;
  [[nodiscard]] Real3x3 stress(const Real3x3& f) const;  ///< P
  [[nodiscard]] Real3x3 change(const Real3x3& f, const Real3x3& df) const;

 private:
  struct Family {
    Real k1, k2;
    Real3x3 structure;  // kappa I + (1 - 3 kappa) a a^T
    [[nodiscard]] Real stretched(const Real3x3& f) const;
  };
  [[nodiscard]] Real3x3 linear_stress(const Real3x3& strain) const;

  std::vector<Family> families_;
  bool linear_ = false;
  // Of law "linear": along and two across, as columns; elasticity in these axes, and of the matrix.
  Real3x3 axes_ = Real3x3::Identity();
  Eigen::Matrix<Real, 6, 6> d_ = Eigen::Matrix<Real, 6, 6>::Zero(), less_ = d_;
};

}  // namespace sunder::plain
