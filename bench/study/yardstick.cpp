// SPDX-License-Identifier: Apache-2.0
#include "bench/study/yardstick.hpp"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

namespace sunder::bench {
namespace {

using plain::Real;
using plain::Real3x3;

const Real3x3 kOne = Real3x3::Identity();
// Of the displacement: Newton's method is close from there on; what its last step may change.
constexpr double kClose = 1e-4, kLargestCorrection = 1e-10;
constexpr int kMostFactors = 40;
constexpr auto kNoPatch = std::numeric_limits<std::size_t>::max();

Real3x3 strain_of(const Real3x3& f) { return (f + f.transpose()) / 2 - kOne; }
Real3x3 deviator(const Real3x3& e) { return e - e.trace() / 3 * kOne; }

/// Per element a node of the body that it belongs to: live elements that share nodes are of one.
/// Destroyed ones have none.
std::vector<Index> bodies(const Mesh& mesh, std::span<const std::uint8_t> destroyed) {
  constexpr Index kNobody = -1;
  std::vector<std::vector<std::size_t>> elements_at(mesh.nodes.size());
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    for (Index n : mesh.tets[e]) elements_at[static_cast<std::size_t>(n)].push_back(e);
  }
  std::vector<Index> body(mesh.tets.size(), kNobody);
  std::vector<std::size_t> front;
  for (std::size_t first = 0; first < mesh.tets.size(); ++first) {
    if (!destroyed[first] && body[first] == kNobody) front.push_back(first);
    while (!front.empty()) {
      const std::size_t e = front.back();
      front.pop_back();
      if (destroyed[e] || body[e] != kNobody) continue;
      body[e] = mesh.tets[first][0];
      for (Index n : mesh.tets[e]) {
        const auto& next = elements_at[static_cast<std::size_t>(n)];
        front.insert(front.end(), next.begin(), next.end());
      }
    }
  }
  return body;
}

}  // namespace

bool pools_volume(const Problem& problem) {
  return std::ranges::any_of(problem.scene().materials, [](const auto& named) {
    return named.second.volume == MaterialVolume::pooled;
  });
}

Yardstick::Yardstick(const Problem& problem, std::span<const std::uint8_t> destroyed)
    : problem_(problem),
      places_(static_cast<std::size_t>(problem.dof_count())),
      free_(places_.size(), 1) {
  const bool finite = problem.finite() || problem.fibrous() || problem.interfaces();
  const double left = finite ? 0 : problem.scene().fracture.alpha;
  const fem::Pools pools(problem);
  patches_.resize(static_cast<std::size_t>(pools.count()));
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Material& material = problem.material(e);
    const std::size_t id = elements_.size();
    elements_.emplace_back(problem.mesh(), e, material);
    plain::Element& element = elements_.back();
    if (destroyed[id]) element.share = left;
    const bool linear = material.law == MaterialLaw::linear;
    laws_.push_back(linear                                     ? &plain::kLinear
                    : material.law == MaterialLaw::corotated   ? &plain::kCorotated
                    : material.law == MaterialLaw::neo_hookean ? &plain::kNeoHookean
                                                               : &plain::kSaintVenantKirchhoff);
    if (problem.fibrous()) fibres_.emplace_back(problem, e, element);
    const Index p = pools.of(e);
    patch_of_.push_back(p == kNone ? kNoPatch : static_cast<std::size_t>(p));
    if (p == kNone) continue;
    if (!linear && material.law != MaterialLaw::neo_hookean)
      throw std::runtime_error("this yardstick pools laws linear and neo-hookean alone");
    Patch& patch = patches_[static_cast<std::size_t>(p)];
    patch.shear = element.d(3, 3);
    patch.bulk = element.d(0, 1) + 2 * element.d(3, 3) / 3;
    patch.linear = linear;
    patch.elements.push_back(id);
  }
  split_patches(bodies(problem.mesh(), destroyed));
  for (std::size_t i = 0; i < problem.dofs().size(); ++i) {
    if (problem.dofs()[i] != kNone) places_[static_cast<std::size_t>(problem.dofs()[i])] = i;
  }
  for (Index d : problem.gripped_dofs()) free_[static_cast<std::size_t>(d)] = 0;
}

/// A patch holds elements of one body; what is destroyed stays with the first.
void Yardstick::split_patches(const std::vector<Index>& body) {
  const std::size_t whole = patches_.size();
  for (std::size_t p = 0; p < whole; ++p) {
    std::map<Index, Patch> parts;  // by body
    std::vector<std::size_t> gone;
    Index first = -1;
    for (std::size_t id : patches_[p].elements) {
      if (body[id] < 0) {
        gone.push_back(id);
        continue;
      }
      if (first < 0) first = body[id];
      parts[body[id]].elements.push_back(id);
    }
    if (parts.size() < 2) continue;
    Patch patch = patches_[p];
    for (auto& [of, part] : parts) {
      patch.elements = std::move(part.elements);
      if (of == first) {
        patch.elements.insert(patch.elements.end(), gone.begin(), gone.end());
        patches_[p] = patch;
        continue;
      }
      for (std::size_t id : patch.elements) patch_of_[id] = patches_.size();
      patches_.push_back(patch);
    }
  }
}

Real3x3 Yardstick::deformed(std::size_t id, const std::vector<Real>& u) const {
  return kOne + elements_[id].gradient(elements_[id].corners(u));
}

/// How an element's measure of volume changes with F: of law linear that is tr F - 2.
Real3x3 Yardstick::cofactor(std::size_t id, const Real3x3& f) const {
  return patches_[patch_of_[id]].linear ? kOne : Real3x3(f.determinant() * f.inverse().transpose());
}

std::vector<Yardstick::Pressure> Yardstick::pressures(const std::vector<Real>& u) const {
  std::vector<Pressure> all;
  for (const Patch& patch : patches_) {
    Pressure of;
    Real now = 0;
    for (std::size_t id : patch.elements) {
      const Real3x3 f = deformed(id, u);
      const Real volume = elements_[id].share * elements_[id].volume;
      of.volume += volume;
      now += volume * (patch.linear ? f.trace() - 2 : f.determinant());
    }
    if (of.volume > 0) {
      const Real j = now / of.volume, lambda = patch.bulk - 2 * patch.shear / 3;
      const Real face = std::pow(j, Real(2) / 3);
      if (!patch.linear && !(j > 0)) throw std::runtime_error("a patch is inside out");
      of.pressure = patch.linear ? patch.bulk * (j - 1)
                                 : (lambda * std::log(j) + patch.shear * (face - 1)) / j;
      of.stiffness = patch.linear
                         ? patch.bulk
                         : (lambda + 2 * patch.shear * face / 3) / (j * j) - of.pressure / j;
    }
    all.push_back(of);
  }
  return all;
}

/// First Piola-Kirchhoff stress, of a whole element.
Real3x3 Yardstick::stress(std::size_t id, const Real3x3& f, const std::vector<Pressure>& of) const {
  Real3x3 p;
  if (const std::size_t at = patch_of_[id]; at == kNoPatch) {
    p = laws_[id]->stress(elements_[id].d, f);
  } else {
    const Real mu = patches_[at].shear;
    p = of[at].pressure * cofactor(id, f);
    if (patches_[at].linear) {
      p += 2 * mu * deviator(strain_of(f));
    } else {
      p += mu * (f - std::pow(f.determinant(), Real(2) / 3) * f.inverse().transpose());
    }
  }
  if (!fibres_.empty()) p += fibres_[id].stress(f);
  return p;
}

/// The same, as F changes and the pressure does not.
Real3x3 Yardstick::change(std::size_t id, const Real3x3& f, const Real3x3& df,
                          const std::vector<Pressure>& of) const {
  Real3x3 dp;
  if (const std::size_t at = patch_of_[id]; at == kNoPatch) {
    dp = laws_[id]->change(elements_[id].d, f, df);
  } else if (const Real mu = patches_[at].shear; patches_[at].linear) {
    dp = 2 * mu * deviator((df + df.transpose()) / 2);
  } else {
    const Real3x3 g = f.inverse().transpose();
    const Real along = g.cwiseProduct(df).sum(), j = f.determinant();
    const Real3x3 turned = g * df.transpose() * g;
    dp = mu * (df - std::pow(j, Real(2) / 3) * (2 * along / 3 * g - turned)) +
         of[at].pressure * j * (along * g - turned);
  }
  if (!fibres_.empty()) dp += fibres_[id].change(f, df);
  return dp;
}

std::vector<Real> Yardstick::forces(const std::vector<Real>& u) const {
  std::vector<Real> all(u.size(), 0);
  const std::vector<Pressure> of = pressures(u);
  for (std::size_t id = 0; id < elements_.size(); ++id) {
    const plain::Element& e = elements_[id];
    if (e.share == 0) continue;
    const Real3x3 p = e.share * e.volume * stress(id, deformed(id, u), of);
    for (Index i = 0; i < 12; ++i)
      all[e.places[static_cast<std::size_t>(i)]] += p.row(i % 3).dot(e.slope(i / 3));
  }
  return all;
}

/// -K^-1 r of free dofs; what no live element holds rests.
Eigen::VectorXd Yardstick::step(const std::vector<Real>& u, const Eigen::VectorXd& r) const {
  std::vector<Eigen::Triplet<double>> entries;
  const auto dof = [&](std::size_t place) {
    const Index d = problem_.dofs()[place];
    return d == kNone || !free_[static_cast<std::size_t>(d)] ? kNone : d;
  };
  const auto add = [&](std::size_t row, std::size_t column, Real k) {
    const Index i = dof(row), j = dof(column);
    if (i != kNone && j != kNone && i >= j) entries.emplace_back(i, j, static_cast<double>(k));
  };
  const std::vector<Pressure> of = pressures(u);
  std::vector<std::vector<std::pair<std::size_t, Real>>> volume_of(patches_.size());  // b_p
  for (std::size_t id = 0; id < elements_.size(); ++id) {
    const plain::Element& e = elements_[id];
    if (e.share == 0) continue;
    const Real3x3 f = deformed(id, u);
    const Real volume = e.share * e.volume;
    for (Index j = 0; j < 12; ++j) {
      const std::size_t column = e.places[static_cast<std::size_t>(j)];
      Real3x3 df = Real3x3::Zero();
      df.row(j % 3) = e.slope(j / 3);
      const Real3x3 dp = volume * change(id, f, df, of);
      for (Index i = 0; i < 12; ++i)
        add(e.places[static_cast<std::size_t>(i)], column, dp.row(i % 3).dot(e.slope(i / 3)));
      if (patch_of_[id] != kNoPatch) {
        const Real grows = volume * cofactor(id, f).row(j % 3).dot(e.slope(j / 3));
        auto& b = volume_of[patch_of_[id]];
        const auto at = std::ranges::find(b, column, &std::pair<std::size_t, Real>::first);
        if (at == b.end()) {
          b.emplace_back(column, grows);
        } else {
          at->second += grows;
        }
      }
    }
  }
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    for (const auto& [row, a] : volume_of[p]) {
      for (const auto& [column, b] : volume_of[p])
        add(row, column, of[p].stiffness / of[p].volume * a * b);
    }
  }
  Eigen::SparseMatrix<double> k(r.size(), r.size());
  k.setFromTriplets(entries.begin(), entries.end());
  const double most = k.diagonal().cwiseAbs().maxCoeff();
  for (Index d = 0; d < r.size(); ++d) {
    if (k.coeff(d, d) == 0) k.coeffRef(d, d) = most;
  }
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(k);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0))
    throw std::runtime_error("the yardstick's tangent is not definite");
  return factor.solve(-r);
}

Yardstick::Rest Yardstick::solve(const Load& load, std::span<const double> start) const {
  std::vector<Real> u(problem_.dofs().size(), 0), acting(u);
  std::ranges::copy(start, u.begin());
  const auto gripped = problem_.gripped_dofs();
  const auto place = [&](Index d) { return places_[static_cast<std::size_t>(d)]; };
  for (std::size_t i = 0; i < load.forces.size(); ++i)
    acting[place(load.force_dofs[i])] = load.forces[i];
  for (std::size_t g = 0; g < gripped.size(); ++g) u[place(gripped[g])] = load.displacements[g];
  Rest rest;
  double before = std::numeric_limits<double>::infinity();
  for (int factors = 0;; ++factors) {
    const std::vector<Real> f = forces(u);
    Eigen::VectorXd r(static_cast<Index>(places_.size()));
    Real left = 0, size = 0;
    for (std::size_t d = 0; d < places_.size(); ++d) {
      const Real off = f[places_[d]] - acting[places_[d]];
      r[static_cast<Index>(d)] = free_[d] ? static_cast<double>(off) : 0;
    }
    const Eigen::VectorXd du = step(u, r);
    for (std::size_t d = 0; d < places_.size(); ++d) {
      u[places_[d]] += du[static_cast<Index>(d)];
      left += Real(du[static_cast<Index>(d)]) * du[static_cast<Index>(d)];
      size += u[places_[d]] * u[places_[d]];
    }
    rest.correction = size == 0 ? 0 : static_cast<double>(std::sqrt(left / size));
    if (rest.correction < kClose && !(rest.correction < before / 2)) break;  // at rounding
    if (rest.correction == 0) break;
    if (factors == kMostFactors || !std::isfinite(rest.correction))
      throw std::runtime_error("the yardstick does not come to rest");
    before = rest.correction;
  }
  if (!(rest.correction <= kLargestCorrection))
    throw std::runtime_error("the yardstick's corrections do not vanish");
  rest.u.assign(u.begin(), u.end());
  const std::vector<Pressure> of = pressures(u);
  for (std::size_t id = 0; id < elements_.size(); ++id) {
    const Real3x3 f = deformed(id, u);
    Real3x3 s = Real3x3::Zero();
    if (elements_[id].share > 0) s = elements_[id].share * stress(id, f, of);
    if (problem_.in_interface(static_cast<Index>(id))) {
      if (laws_[id] != &plain::kLinear) s = plain::rotation(f).transpose() * s;
    } else if (laws_[id] != &plain::kLinear) {
      s = s * f.transpose() / f.determinant();
    }
    s = (s + s.transpose()).eval() / 2;
    const plain::Real6 voigt{s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)};
    rest.stress.push_back(voigt.cast<double>());
  }
  return rest;
}

}  // namespace sunder::bench
