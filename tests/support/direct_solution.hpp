// SPDX-License-Identifier: Apache-2.0
// The tests' own finite element solution, sharing no formula with the library: shape functions by
// inverting [1 x y z], elasticity by inverting the compliance, elimination of every known dof, a
// dense Cholesky factor, and refinement with residuals in extended precision.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::test {

using Real = long double;
using Known = std::map<Index, double>;  ///< prescribed displacement by 3 * node + axis

class DirectSolution {
 public:
  using Element = Eigen::Matrix<Real, 12, 12>;
  using Strain = Eigen::Matrix<Real, 6, 12>;
  using Elasticity = Eigen::Matrix<Real, 6, 6>;

  /// `scale` multiplies each element's stiffness; `known` adds prescribed dofs to the supports.
  DirectSolution(const Problem& problem, std::vector<double> scale, Known known = {})
      : problem_(problem), scale_(std::move(scale)), known_(std::move(known)) {
    for (Index e = 0; e < problem.tet_count(); ++e) elements_.push_back(stiffness(e));
    number_unknowns();
    factorise();
  }

  static Strain strain_matrix(const Mesh& mesh, Index e, Real& volume) {
    Eigen::Matrix<Real, 4, 4> corners;
    for (int a = 0; a < 4; ++a) {
      corners(a, 0) = 1;
      for (int i = 0; i < 3; ++i) corners(a, i + 1) = mesh.nodes[mesh.tets[e][a]][i];
    }
    volume = corners.determinant() / 6;
    const Eigen::Matrix<Real, 4, 4> coefficients = corners.inverse();  // column a: N_a
    Strain b = Strain::Zero();
    for (int a = 0; a < 4; ++a) {
      const Real x = coefficients(1, a), y = coefficients(2, a), z = coefficients(3, a);
      b.col(3 * a) << x, 0, 0, y, 0, z;
      b.col(3 * a + 1) << 0, y, 0, x, z, 0;
      b.col(3 * a + 2) << 0, 0, z, 0, y, x;
    }
    return b;
  }

  static Elasticity elasticity(const Material& m) {
    Elasticity compliance = Elasticity::Zero();
    const Real e = m.young, nu = m.poisson;
    compliance.topLeftCorner<3, 3>().setConstant(-nu / e);
    compliance.diagonal() << 1 / e, 1 / e, 1 / e, 2 * (1 + nu) / e, 2 * (1 + nu) / e,
        2 * (1 + nu) / e;
    return compliance.inverse();
  }

  /// Displacement at all nodes under nodal forces (3 * nodes).
  [[nodiscard]] std::vector<double> solve(std::span<const double> force) const {
    std::vector<Real> u(force.size(), 0);
    for (const auto& [i, value] : known_) u[i] = value;
    for (int pass = 0; pass < 5; ++pass) {
      const std::vector<Real> ku = multiply(u);
      Eigen::VectorXd r(unknowns_);
      for (std::size_t i = 0; i < u.size(); ++i) {
        if (number_[i] != kNone) r[number_[i]] = static_cast<double>(force[i] - ku[i]);
      }
      const Eigen::VectorXd du = llt_.solve(r);
      for (std::size_t i = 0; i < u.size(); ++i) {
        if (number_[i] != kNone) u[i] += du[number_[i]];
      }
    }
    return {u.begin(), u.end()};
  }

  /// K u at all dofs, minus the applied forces: what supports and grips exert.
  [[nodiscard]] std::vector<double> reactions(std::span<const double> u,
                                              std::span<const double> force) const {
    const std::vector<Real> ku = multiply({u.begin(), u.end()});
    std::vector<double> r(ku.size());
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = static_cast<double>(ku[i] - force[i]);
    return r;
  }

  /// Element stress a_e D B u.
  [[nodiscard]] std::vector<Voigt> stress(std::span<const double> u) const {
    std::vector<Voigt> all;
    for (Index e = 0; e < problem_.tet_count(); ++e) {
      Real volume = 0;
      const Strain b = strain_matrix(problem_.mesh(), e, volume);
      Eigen::Matrix<Real, 12, 1> ue;
      for (int i = 0; i < 12; ++i) ue[i] = u[3 * problem_.mesh().tets[e][i / 3] + i % 3];
      all.push_back((scale_[e] * (elasticity(problem_.material(e)) * (b * ue))).cast<double>());
    }
    return all;
  }

 private:
  Element stiffness(Index e) const {
    Real volume = 0;
    const Strain b = strain_matrix(problem_.mesh(), e, volume);
    return scale_[e] * volume * (b.transpose() * elasticity(problem_.material(e)) * b);
  }

  void number_unknowns() {
    number_.assign(3 * problem_.mesh().nodes.size(), kNone);
    for (std::size_t i = 0; i < number_.size(); ++i) {
      const bool free = problem_.dofs()[i] != kNone && !known_.contains(static_cast<Index>(i));
      if (free) number_[i] = unknowns_++;
    }
  }

  void factorise() {
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(unknowns_, unknowns_);
    for (Index e = 0; e < problem_.tet_count(); ++e) {
      for (int j = 0; j < 12; ++j) {
        for (int i = 0; i < 12; ++i) {
          const Index row = number_[dof(e, i)], column = number_[dof(e, j)];
          if (row != kNone && column != kNone && row >= column) {
            k(row, column) += static_cast<double>(elements_[e](i, j));
          }
        }
      }
    }
    llt_.compute(k);
    if (llt_.info() != Eigen::Success) throw std::runtime_error("yardstick is not definite");
  }

  std::vector<Real> multiply(const std::vector<Real>& u) const {
    std::vector<Real> y(u.size(), 0);
    for (Index e = 0; e < problem_.tet_count(); ++e) {
      Eigen::Matrix<Real, 12, 1> ue;
      for (int i = 0; i < 12; ++i) ue[i] = u[dof(e, i)];
      const Eigen::Matrix<Real, 12, 1> fe = elements_[e] * ue;
      for (int i = 0; i < 12; ++i) y[dof(e, i)] += fe[i];
    }
    return y;
  }

  std::size_t dof(Index e, int i) const {
    return static_cast<std::size_t>(3 * problem_.mesh().tets[e][i / 3] + i % 3);
  }

  const Problem& problem_;
  std::vector<double> scale_;
  Known known_;
  std::vector<Element> elements_;
  std::vector<Index> number_;
  Index unknowns_ = 0;
  Eigen::LLT<Eigen::MatrixXd> llt_;
};

}  // namespace sunder::test
