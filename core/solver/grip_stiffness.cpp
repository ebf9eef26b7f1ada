// SPDX-License-Identifier: Apache-2.0
#include "solver/grip_stiffness.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <functional>

namespace sunder::solver {
namespace {

using linear_algebra::RowMajor;

// Of the stiffest direction: what a direction without stiffness gets.
constexpr double kLeastStiffness = 1e-9;
// Conjugate gradients for how the rest follows: a step that wins so little of the energy is the
// last one (bench_motion prints how many there are).
constexpr double kLeastGain = 1e-3;
constexpr int kMostFollowing = 12;

/// The elements at the grips: K_FG, with the unknowns in the base's order, and K_GG.
struct AtGrips {
  RowMajor between;
  Eigen::MatrixXd within;
};

AtGrips tangent_at_grips(const RestingBody& now,
                         const std::function<fem::ElementMatrix(Index)>& of_element,
                         std::span<const fem::PatchTangent> patches,
                         const linear_algebra::Supernodes& order) {
  const Problem& problem = now.body().problem;
  const auto gripped = problem.gripped_dofs();
  const auto count = static_cast<Index>(gripped.size());
  std::vector<Index> column(static_cast<std::size_t>(problem.dof_count()), kNone);
  for (Index g = 0; g < count; ++g) column[gripped[g]] = g;
  AtGrips of{RowMajor::Zero(problem.dof_count(), count), Eigen::MatrixXd::Zero(count, count)};
  const auto column_of = [&](Index d) { return d == kNone ? kNone : column[d]; };
  const auto add = [&](std::span<const Index> dofs, const auto& k) {
    for (std::size_t j = 0; j < dofs.size(); ++j) {
      const Index to = column_of(dofs[j]);
      for (std::size_t i = 0; i < dofs.size() && to != kNone; ++i) {
        const Index own = column_of(dofs[i]);
        if (own != kNone) {
          of.within(own, to) += k(i, j);
        } else if (dofs[i] != kNone) {
          of.between(order.place[dofs[i]], to) += k(i, j);
        }
      }
    }
  };
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (now.out()[e]) continue;
    std::array<Index, 12> dofs;
    for (int i = 0; i < 12; ++i) dofs[i] = problem.dof(problem.mesh().tets[e][i / 3], i % 3);
    if (std::ranges::all_of(dofs, [&](Index d) { return column_of(d) == kNone; })) continue;
    const fem::ElementMatrix k = of_element(e);
    add(dofs, [&](std::size_t i, std::size_t j) {
      return k(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    });
  }
  std::vector<Index> dofs;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const Eigen::VectorXd& b = patches[p].b;
    if (b.size() == 0) continue;
    dofs.clear();
    for (Index n : now.body().pools()->nodes(problem, static_cast<Index>(p))) {
      for (int axis = 0; axis < 3; ++axis) dofs.push_back(problem.dof(n, axis));
    }
    add(dofs, [&](std::size_t i, std::size_t j) {
      return patches[p].factor * b[static_cast<Eigen::Index>(i)] * b[static_cast<Eigen::Index>(j)];
    });
  }
  return of;
}

/// x <- K^-1 b of free unknowns by conjugate gradients, all columns abreast; each stops where a
/// step wins next to nothing of its energy, or finds a direction without stiffness.
class BlockConjugateGradients {
 public:
  BlockConjugateGradients(const linear_algebra::SparseMatrix& k,
                          const linear_algebra::Supernodes& order, FiniteBase& base)
      : k_(k), order_(order), base_(base) {}

  void solve(const RowMajor& b, RowMajor& x) {
    using Row = Eigen::RowVectorXd;
    x.setZero(b.rows(), b.cols());
    RowMajor r = b, z, p, q;
    Row won = Row::Zero(b.cols()), before;
    std::vector<std::uint8_t> done(static_cast<std::size_t>(b.cols()), 0);
    for (int i = 0; i < kMostFollowing; ++i) {
      z = r;
      base_.solve_ordered(order_, z);
      const Row now = (r.array() * z.array()).colwise().sum();
      if (i == 0) {
        p = z;
      } else {
        const Row beta = (before.array() > 0).select(now.array() / before.array(), 0.0);
        p = z + p * beta.asDiagonal();
      }
      before = now;
      q.noalias() = k_.selfadjointView<Eigen::Lower>() * p;
      const Row stiff = (p.array() * q.array()).colwise().sum();
      Row length = Row::Zero(b.cols());
      bool all = true;
      for (Eigen::Index c = 0; c < b.cols(); ++c) {
        std::uint8_t& stop = done[static_cast<std::size_t>(c)];
        if (stop || !(stiff[c] > 0)) {
          stop = 1;
          continue;
        }
        length[c] = now[c] / stiff[c];
        won[c] += length[c] * now[c];
        stop = length[c] * now[c] <= kLeastGain * won[c];
        all = all && stop;
      }
      x += p * length.asDiagonal();
      r -= q * length.asDiagonal();
      if (all) break;
    }
  }

 private:
  const linear_algebra::SparseMatrix& k_;
  const linear_algebra::Supernodes& order_;
  FiniteBase& base_;
};

/// Grips of nodes that have parted go with those of the others.
Eigen::MatrixXd of_whole_grips(const Problem& problem, Eigen::MatrixXd s) {
  const auto parted = problem.parted_grips();
  const Eigen::Index whole = s.rows() - static_cast<Eigen::Index>(parted.size());
  for (std::size_t i = 0; i < parted.size(); ++i) {
    s.row(parted[i]) += s.row(whole + static_cast<Eigen::Index>(i));
  }
  for (std::size_t i = 0; i < parted.size(); ++i) {
    s.col(parted[i]) += s.col(whole + static_cast<Eigen::Index>(i));
  }
  return s.topLeftCorner(whole, whole);
}

}  // namespace

Eigen::MatrixXd grip_stiffness(const RestingBody& now, std::span<const double> u,
                               const fem::TangentPattern& pattern, FiniteBase& base,
                               const GripTangent& of) {
  const Problem& problem = now.body().problem;
  const auto& order = *pattern.supernodes();
  const fem::PatchVolumes volumes(now.body(), u);
  const std::vector<fem::PatchTangent> patches =
      fem::patch_tangents(now.body(), u, volumes.stiffness(), fem::Tangent::exact);
  const std::function<fem::ElementMatrix(Index)> of_element = [&](Index e) -> fem::ElementMatrix {
    const fem::ElementMatrix elastic =
        fem::element_tangent(now.body(), e, u, fem::Tangent::exact, volumes.pressure());
    return of.viscosity ? elastic + of.viscosity->tangent(e, u, of.viscous) : elastic;
  };
  AtGrips at = tangent_at_grips(now, of_element, patches, order);
  const linear_algebra::SparseMatrix k =
      pattern.tangent(now.body(), of_element, patches, of.inertia);
  for (Index d = 0; d < problem.dof_count(); ++d) {
    if (now.frozen()[d]) at.between.row(order.place[d]).setZero();
  }
  base.turn(now, u);
  RowMajor follows;
  BlockConjugateGradients(k, order, base).solve(-at.between, follows);
  // Rayleigh and Ritz: an error of how the rest follows enters squared.
  const RowMajor forces = at.between + RowMajor(k.selfadjointView<Eigen::Lower>() * follows);
  Eigen::MatrixXd s = at.within + at.between.transpose() * follows;
  s += follows.transpose() * forces;
  if (of.felt_inertia) {
    const auto gripped = problem.gripped_dofs();
    for (std::size_t g = 0; g < gripped.size(); ++g) {
      const auto i = static_cast<Eigen::Index>(g);
      s(i, i) += of.inertia.of(gripped[g]);
    }
  }
  return of_whole_grips(problem, (s + s.transpose()) / 2);
}

Eigen::MatrixXd compliance_factor(const Eigen::MatrixXd& stiffness,
                                  std::span<const double> anchors) {
  const Eigen::Index n = stiffness.rows();
  Eigen::MatrixXd s = stiffness;
  s.diagonal() += Eigen::Map<const Eigen::VectorXd>(anchors.data(), n);
  const double least = kLeastStiffness * std::max(s.diagonal().cwiseAbs().maxCoeff(), 1e-300);
  // From the last unknown to the first: s = U U^T, so that L = U^-T is lower.
  const auto upper = [n](const Eigen::MatrixXd& of, Eigen::MatrixXd& u) {
    const Eigen::LLT<Eigen::MatrixXd> llt(of.reverse());
    u = Eigen::MatrixXd(llt.matrixL()).reverse();
    return llt.info() == Eigen::Success && n > 0;
  };
  Eigen::MatrixXd u;
  if (!upper(s, u) || u.diagonal().cwiseAbs2().minCoeff() < least) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(s);
    const Eigen::VectorXd held = modes.eigenvalues().cwiseMax(least);
    s = modes.eigenvectors() * held.asDiagonal() * modes.eigenvectors().transpose();
    static_cast<void>(upper(s, u));
  }
  Eigen::MatrixXd l = Eigen::MatrixXd::Identity(n, n);
  u.transpose().triangularView<Eigen::Lower>().solveInPlace(l);
  return l;
}

}  // namespace sunder::solver
