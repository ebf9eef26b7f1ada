// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "cpu_reference/plain/plain.hpp"

namespace sunder::plain {
namespace {

double largest(const std::vector<Voigt>& stress) {
  const Eigen::Map<const Eigen::ArrayXd> all(stress.front().data(), 6 * std::ssize(stress));
  return all.abs().maxCoeff<Eigen::PropagateNaN>();
}

}  // namespace

Body::Body(const Problem& problem, std::span<const std::uint8_t> destroyed)
    : problem_(problem),
      places_(static_cast<std::size_t>(problem.dof_count())),
      free_(places_.size(), 1) {
  for (Index e = 0; e < problem.tet_count(); ++e) {
    elements_.emplace_back(problem.mesh(), e, problem.material(e));
    if (!destroyed.empty() && destroyed[e]) destroy({&e, 1});
  }
  for (std::size_t i = 0; i < problem.dofs().size(); ++i) {
    if (problem.dofs()[i] != kNone) places_[problem.dofs()[i]] = i;
  }
  for (Index d : problem.gripped_dofs()) free_[d] = 0;
}

void Body::destroy(std::span<const Index> elements) {
  for (Index e : elements) elements_[e].share = problem_.scene().fracture.alpha;
  factorised_ = false;
}

/// Lower triangle of K; gripped dofs, whose displacement is known, are uncoupled.
void Body::factorise() {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index d : problem_.gripped_dofs()) entries.emplace_back(d, d, 1.0);
  for (const Element& element : elements_) {
    const Eigen::Matrix<double, 12, 12> k = element.stiffness().cast<double>();
    for (Index i = 0; i < 12; ++i) {
      const Index row = problem_.dofs()[element.places[i]];
      for (Index j = 0; j < 12 && row != kNone && free_[row]; ++j) {
        const Index column = problem_.dofs()[element.places[j]];
        if (column != kNone && column <= row && free_[column]) {
          entries.emplace_back(row, column, k(i, j));
        }
      }
    }
  }
  Eigen::SparseMatrix<double> lower(problem_.dof_count(), problem_.dof_count());
  lower.setFromTriplets(entries.begin(), entries.end());
  factor_.compute(lower);
  if (factor_.info() != Eigen::Success || !(factor_.vectorD().minCoeff() > 0)) {
    throw std::runtime_error("the yardstick's stiffness is not definite");
  }
  factorised_ = true;
}

std::vector<Real> Body::forces(const std::vector<Real>& u) const {
  std::vector<Real> f(u.size(), 0);
  for (const Element& element : elements_) {
    const Real12 of = element.forces(element.corners(u));
    for (Index i = 0; i < 12; ++i) f[element.places[i]] += of[i];
  }
  return f;
}

/// Adds A^-1 (f - K u) to u until that is no longer half of what it was: rounding.
void Body::refine(const std::vector<Real>& f, std::vector<Real>& u, Solution& s) const {
  double before = std::numeric_limits<double>::infinity();
  for (;; before = s.error) {
    const std::vector<Real> ku = forces(u);
    Eigen::VectorXd r(problem_.dof_count());
    for (Index d = 0; d < r.size(); ++d) {
      r[d] = free_[d] ? static_cast<double>(f[places_[d]] - ku[places_[d]]) : 0;
    }
    const Eigen::VectorXd correction = factor_.solve(r);
    std::vector<double> du(u.size(), 0.0);
    for (Index d = 0; d < r.size(); ++d) u[places_[d]] += du[places_[d]] = correction[d];
    s.displacement.assign(u.begin(), u.end());
    s.stress = stress(u);
    const double off = largest(stress(du));
    s.error = off == 0 ? 0 : off / largest(s.stress);
    if (!(s.error < before / 2)) return;
  }
}

Solution Body::solve(const Load& load) {
  if (!factorised_) factorise();
  const auto gripped = problem_.gripped_dofs();
  std::vector<Real> f(problem_.dofs().size(), 0), u(f);
  for (std::size_t i = 0; i < load.forces.size(); ++i) {
    f[places_[load.force_dofs[i]]] = load.forces[i];
  }
  for (std::size_t g = 0; g < gripped.size(); ++g) u[places_[gripped[g]]] = load.displacements[g];
  Solution s;
  refine(f, u, s);
  Real left = 0, acting = 0;  // squares
  const std::vector<Real> ku = forces(u);
  for (std::size_t d = 0; d < places_.size(); ++d) {
    const Real off = ku[places_[d]] - f[places_[d]];
    (free_[d] ? left : acting) += off * off;
    acting += f[places_[d]] * f[places_[d]];
    if (!free_[d]) s.reactions.push_back(static_cast<double>(off));
  }
  s.residual = acting > 0 ? static_cast<double>(std::sqrt(left / acting)) : 0;
  return s;
}

Deformation Body::deformation(std::span<const double> u,
                              std::span<const std::uint8_t> left_out) const {
  Deformation most;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    if (elements_[e].share < 1 || left_out[e]) continue;
    const Real3x3 h = elements_[e].gradient(elements_[e].corners(u));
    const auto p = principal_values((h + h.transpose()) / 2);
    const auto strain = static_cast<double>(-p[0] > p[2] ? p[0] : p[2]);
    if (std::abs(strain) > std::abs(most.strain)) most.strain = strain;
    most.rotation_deg = std::max(most.rotation_deg, static_cast<double>(rotation_deg(h)));
    most.inverted += (Real3x3::Identity() + h).determinant() <= 0;
  }
  return most;
}

}  // namespace sunder::plain
