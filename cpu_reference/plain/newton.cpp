// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <stdexcept>
#include <utility>

#include "cpu_reference/plain/finite.hpp"

namespace sunder::plain {

/// Less the work of the load; r = internal forces - load, per dof.
Real FiniteBody::energy(const std::vector<Real>& u, const Eigen::VectorXd& load,
                        Eigen::VectorXd& r) const {
  std::vector<Real> forces(u.size(), 0);
  Real sum = 0;
  for (const Element& e : elements_) {
    if (e.share < 1) continue;
    const Real3x3 f = Real3x3::Identity() + e.gradient(e.corners(u));
    sum += e.volume * law_.energy(e.d, f);
    const Real3x3 p = law_.stress(e.d, f);
    for (Index i = 0; i < 12; ++i)
      forces[e.places[i]] += e.volume * p.row(i % 3).dot(e.slope(i / 3));
  }
  for (Index d = 0; d < r.size(); ++d) {
    r[d] = static_cast<double>(forces[places_[d]] - load[d]);
    sum -= load[d] * u[places_[d]];
  }
  return sum;
}

/// -K^-1 r of free dofs, of K + shift where K is indefinite; what no live element holds rests.
Eigen::VectorXd FiniteBody::step(const std::vector<Real>& u, const Eigen::VectorXd& r) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (const Element& e : elements_) {
    for (Index j = 0; j < 12 && e.share == 1; ++j) {
      const Index column = problem_.dofs()[e.places[j]];
      Real3x3 df = Real3x3::Zero();
      df.row(j % 3) = e.slope(j / 3);
      const Real3x3 dp = law_.change(e.d, Real3x3::Identity() + e.gradient(e.corners(u)), df);
      for (Index i = 0; i < 12; ++i) {
        const Index row = problem_.dofs()[e.places[i]];
        if (column == kNone || row < column || !free_[row] || !free_[column]) continue;
        const Real k = e.volume * dp.row(i % 3).dot(e.slope(i / 3));
        entries.emplace_back(row, column, static_cast<double>(k));
      }
    }
  }
  Eigen::SparseMatrix<double> k(r.size(), r.size());
  k.setFromTriplets(entries.begin(), entries.end());
  const double most = k.diagonal().cwiseAbs().maxCoeff();
  for (double shift = 0; !(shift > 10 * most); shift = std::max(10 * shift, 1e-6 * most)) {
    Eigen::SparseMatrix<double> shifted = k;
    for (Index d = 0; d < r.size(); ++d) {
      shifted.coeffRef(d, d) = k.coeff(d, d) == 0 ? most : k.coeff(d, d) + shift;
    }
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(shifted);
    if (factor.info() == Eigen::Success && factor.vectorD().minCoeff() > 0) return factor.solve(-r);
  }
  throw std::runtime_error("the yardstick's tangent is not finite");
}

Solution FiniteBody::solve(const Load& load, std::span<const double> start) const {
  Eigen::VectorXd acting = Eigen::VectorXd::Zero(problem_.dof_count()), r(acting);
  for (std::size_t i = 0; i < load.forces.size(); ++i) acting[load.force_dofs[i]] = load.forces[i];
  std::vector<Real> u(problem_.dofs().size(), 0);
  std::ranges::copy(start, u.begin());
  const auto gripped = problem_.gripped_dofs();
  for (std::size_t g = 0; g < gripped.size(); ++g) u[places_[gripped[g]]] = load.displacements[g];
  Real w = energy(u, acting, r);
  for (int factors = 0; factors < 500; ++factors) {
    Solution s;
    const Eigen::VectorXd all = r;
    for (Index d : gripped) s.reactions.push_back(std::exchange(r[d], 0));
    s.displacement.assign(u.begin(), u.end());
    s.residual = r.norm() / std::hypot(acting.norm(), (all - r).norm());
    if (s.residual <= 1e-10 || r.norm() == 0) return s;
    const Eigen::VectorXd du = step(u, r);
    const Real slope = r.dot(du), before = w;
    double part = 2;
    do {
      if (!((part /= 2) > 1e-12)) throw std::runtime_error("the yardstick's energy does not fall");
      for (Index d = 0; d < du.size(); ++d)
        u[places_[d]] = s.displacement[places_[d]] + part * du[d];
      w = energy(u, acting, r);
    } while (!(w <= before + 1e-4 * part * slope + 1e-16 * std::abs(before)));
  }
  throw std::runtime_error("the yardstick does not come to rest");
}

}  // namespace sunder::plain
