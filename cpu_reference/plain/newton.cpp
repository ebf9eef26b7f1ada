// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "cpu_reference/plain/finite.hpp"
#include "sunder/interfaces.hpp"

namespace sunder::plain {

Real FiniteBody::energy(std::size_t element, const Real3x3& f) const {
  const Real w = laws_[element]->energy(elements_[element].d, f);
  return fibres_.empty() ? w : w + fibres_[element].energy(f);
}
Real3x3 FiniteBody::stress(std::size_t element, const Real3x3& f) const {
  Real3x3 p = laws_[element]->stress(elements_[element].d, f);
  if (!fibres_.empty()) p += fibres_[element].stress(f);
  return p;
}
Real3x3 FiniteBody::change(std::size_t element, const Real3x3& f, const Real3x3& df) const {
  Real3x3 dp = laws_[element]->change(elements_[element].d, f, df);
  if (!fibres_.empty()) dp += fibres_[element].change(f, df);
  return dp;
}

/// Less the work of the load; r = internal forces - load, per dof.
Real FiniteBody::energy(const std::vector<Real>& u, const Eigen::VectorXd& load,
                        Eigen::VectorXd& r) const {
  std::vector<Real> forces(u.size(), 0);
  Real sum = 0;
  for (std::size_t id = 0; id < elements_.size(); ++id) {
    const Element& e = elements_[id];
    if (e.share < 1) continue;
    const Real3x3 f = Real3x3::Identity() + e.gradient(e.corners(u));
    sum += e.volume * energy(id, f);
    const Real3x3 p = stress(id, f);
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
  for (std::size_t id = 0; id < elements_.size(); ++id) {
    const Element& e = elements_[id];
    for (Index j = 0; j < 12 && e.share == 1; ++j) {
      const Index column = problem_.dofs()[e.places[j]];
      Real3x3 df = Real3x3::Zero();
      df.row(j % 3) = e.slope(j / 3);
      const Real3x3 f = Real3x3::Identity() + e.gradient(e.corners(u));
      const Real3x3 dp = change(id, f, df);
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
    const double norm = r.norm();
    s.residual = norm / std::hypot(acting.norm(), (all - r).norm());
    if (s.residual <= 1e-10 || r.norm() == 0) return s;
    const Eigen::VectorXd du = step(u, r);
    const Real slope = r.dot(du), before = w;
    // Close to rest the energy changes by less than its last digit: there the residual falls.
    const auto falls = [&](double part) {
      Eigen::VectorXd left = r;
      for (Index d : gripped) left[d] = 0;
      return part == 1 && s.residual < 1e-6 && left.norm() < 0.5 * norm;
    };
    double part = 2;
    do {
      if (!((part /= 2) > 1e-12)) throw std::runtime_error("the yardstick's energy does not fall");
      for (Index d = 0; d < du.size(); ++d)
        u[places_[d]] = s.displacement[places_[d]] + part * du[d];
      w = energy(u, acting, r);
    } while (!(falls(part) || w <= before + 1e-4 * part * slope + 1e-16 * std::abs(before)));
  }
  throw std::runtime_error("the yardstick does not come to rest");
}

FiniteBody::FiniteBody(const Problem& problem, std::span<const std::uint8_t> destroyed)
    : Body(problem, destroyed) {
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const MaterialLaw law = problem.material(e).law;
    laws_.push_back(law == MaterialLaw::linear        ? &kLinear
                    : law == MaterialLaw::corotated   ? &kCorotated
                    : law == MaterialLaw::neo_hookean ? &kNeoHookean
                                                      : &kSaintVenantKirchhoff);
    if (problem.fibrous()) fibres_.emplace_back(problem, e, elements_[e]);
  }
}

std::vector<Voigt> FiniteBody::stress(std::span<const double> u, StressMeasure measure) const {
  std::vector<Voigt> all(elements_.size(), Voigt::Zero());
  for (std::size_t id = 0; id < elements_.size(); ++id) {
    const Element& e = elements_[id];
    if (e.share < 1) continue;
    const Real3x3 f = Real3x3::Identity() + e.gradient(e.corners(u));
    Real3x3 s = stress(id, f);
    const bool biot =
        measure == StressMeasure::biot || problem_.in_interface(static_cast<Index>(id));
    if (laws_[id] != &kLinear && biot) s = rotation(f).transpose() * s;
    if (laws_[id] != &kLinear && !biot) s = s * f.transpose() / f.determinant();
    s = (s + s.transpose()).eval() / 2;
    const Real6 voigt{s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)};
    all[id] = voigt.cast<double>();
  }
  return all;
}

Real FiniteBody::parting_ratio(Index id, std::span<const double> u) const {
  const auto i = static_cast<std::size_t>(id);
  const Element& e = elements_[i];
  const Mesh& mesh = problem_.mesh();
  const InterfaceLayer& layer = problem_.interfaces()->layer(id);
  const auto& interface =
      problem_.scene()
          .interfaces[static_cast<std::size_t>(&layer - problem_.interfaces()->layers().data())];
  // Gradient of what is 0 on the nodes that the first volume has, 1 on the others.
  std::array<bool, 4> upper{true, true, true, true};
  for (std::size_t other = 0; other < mesh.tets.size(); ++other) {
    const auto& tet = mesh.tets[other];
    const auto volume = static_cast<std::size_t>(mesh.volume_of[other]);
    if (mesh.volumes[volume].name != interface.between[0]) continue;
    for (std::size_t a = 0; a < 4; ++a) {
      if (std::ranges::find(tet, mesh.tets[i][a]) != tet.end()) upper[a] = false;
    }
  }
  Eigen::Matrix<Real, 3, 1> normal = Eigen::Matrix<Real, 3, 1>::Zero();
  for (Index a = 0; a < 4; ++a) {
    if (upper[static_cast<std::size_t>(a)]) normal += e.slope(a).transpose();
  }
  const Real3x3 f = Real3x3::Identity() + e.gradient(e.corners(u));
  const Eigen::Matrix<Real, 3, 1> turned = (f.inverse().transpose() * normal).normalized(),
                                  traction = stress(i, f) * normal.normalized();
  const Real along = traction.dot(turned), across = (traction - along * turned).norm();
  return std::hypot(std::max<Real>(along, 0), across / interface.shear_ratio) / interface.strength;
}

Deformation FiniteBody::deformation(std::span<const double> u,
                                    std::span<const std::uint8_t> left_out) const {
  Deformation most;
  for (std::size_t id = 0; id < elements_.size(); ++id) {
    const Element& e = elements_[id];
    if (e.share < 1 || left_out[id] || problem_.in_interface(static_cast<Index>(id))) continue;
    const Real3x3 f = Real3x3::Identity() + e.gradient(e.corners(u));
    const Real3x3 stretch_of =
        laws_[id] == &kLinear ? Real3x3((f + f.transpose()) / 2) : rotation(f).transpose() * f;
    for (const Real stretch : principal_values(stretch_of)) {
      const auto strain = static_cast<double>(stretch - 1);
      if (std::abs(strain) > std::abs(most.strain)) most.strain = strain;
    }
    most.rotation_deg =
        std::max(most.rotation_deg, static_cast<double>(rotation_deg(e.gradient(e.corners(u)))));
    most.inverted += f.determinant() <= 0;
  }
  return most;
}

}  // namespace sunder::plain
