// SPDX-License-Identifier: Apache-2.0
// What a DamageSolver is told of the small matrices, and the solution by it (damage_solver.hpp).
#include <algorithm>
#include <array>
#include <cmath>

#include "solver/deferred.hpp"

namespace sunder::solver {

using linear_algebra::make_room;
using linear_algebra::padded;

namespace {

// Refinements of a solution at once, and one by one after these: two to three are the rule.
constexpr std::size_t kAtOnce = 3, kMore = 1;

bool finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

}  // namespace

void Deferred::solve_by(DamageSolver* solver) {
  elsewhere_ = solver;
  if (elsewhere_) elsewhere_->forget();
}

/// M += Z C^-1 Z^T, or -= where stiffness comes (s = -1), is followed by the same of S, whose Z is
/// that of M without what the grips hold. With Y = (E + M G_G)^T B^T X B U and H = C^-1 Y of the
/// grips, Z_S = Z - (E + M G_G) H, C_S = I - s (B^T X B U)^T Z_S, and T += s Z_S C_S^-1 H^T.
void Deferred::update_elsewhere(Eigen::Index width, bool more) {
  if (!elsewhere_ || !elsewhere_->follows(static_cast<Index>(rank_), count_)) return;
  DamageSolver::Work& work = elsewhere_->work;
  const Eigen::Index n = count(), g = grips(), k = rank_;
  make_room(work.w, width, padded(n));
  make_room(work.v, width, std::max<Eigen::Index>(g, 1));
  auto w = work.w.topLeftCorner(k, n);
  if (g == 0) {
    w = zt_.topLeftCorner(k, n);
    elsewhere_->update(work.w, work.v, static_cast<Index>(k), count_, more);
    return;
  }
  make_room(work.y, g, width);
  make_room(work.z, n, width);
  if (work.c.rows() < width) work.c.resize(width, width);
  const auto xu = xu_.topLeftCorner(n, k);
  auto h = work.y.topLeftCorner(g, k);
  auto z = work.z.topLeftCorner(n, k);
  auto c = work.c.topLeftCorner(k, k);
  h.noalias() = under_grips_.leftCols(n) * xu;
  for (Eigen::Index i = 0; i < g; ++i) h.row(i) += xu.row(column_of_grip(i));
  grip_block_.solveInPlace(h);
  z = z_.topLeftCorner(n, k);
  z.noalias() -= under_grips_.leftCols(n).transpose() * h;
  for (Eigen::Index i = 0; i < g; ++i) z.row(column_of_grip(i)) -= h.row(i);
  c.noalias() = xu.transpose() * z;
  if (!more) c = -c;
  c.diagonal().array() += 1;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(c);
  auto v = work.v.topLeftCorner(k, g);
  w = z.transpose();
  v = h.transpose();
  if (llt.info() == Eigen::Success) {
    llt.matrixL().solveInPlace(w);
    llt.matrixL().solveInPlace(v);
  }
  if (llt.info() == Eigen::Success && w.allFinite() && v.allFinite()) {
    elsewhere_->update(work.w, work.v, static_cast<Index>(k), count_, more);
  } else {
    elsewhere_->forget_forces();
  }
}

/// False: the host has to.
bool Deferred::solve_elsewhere(const Eigen::VectorXd& p, std::span<const double> displacement,
                               double tolerance) {
  if (!elsewhere_ || !border_.empty() || !elsewhere_->takes(count(), grips())) return false;
  try {
    if (bring_elsewhere() && refine_elsewhere(p, displacement, tolerance)) return true;
  } catch (...) {
    elsewhere_->forget();  // of what it had been told none may have come
    throw;
  }
  return false;
}

bool Deferred::bring_elsewhere() {
  DamageSolver::Work& work = elsewhere_->work;
  const Eigen::Index n = count(), g = grips();
  work.held.clear();
  for (const Held& held : held_) work.held.push_back(held.column);
  work.only_grips.clear();
  for (Index d : units_) work.only_grips.push_back(unit_[d]);
  if (g > 0 && elsewhere_->wants_grips()) {
    make_room(work.of_grips, g, n);
    make_room(work.t, g, n);
    auto of_grips = work.of_grips.topLeftCorner(g, n), t = work.t.topLeftCorner(g, n);
    of_grips = under_grips_.leftCols(n);
    for (Eigen::Index i = 0; i < g; ++i) of_grips(i, column_of_grip(i)) += 1;
    grip_block_.matrixL().solveInPlace(of_grips);
    t = of_grips;
    grip_block_.matrixU().solveInPlace(t);
  }
  return elsewhere_->bring(
      {count_, &compliance_, &m_, &d_, work.held, work.only_grips, &work.t, &work.of_grips});
}

/// False where that is no solution.
bool Deferred::refine_elsewhere(const Eigen::VectorXd& p, std::span<const double> displacement,
                                double tolerance) {
  std::array<double, kAtOnce> energies{};
  std::array<double, kMore> more{};
  elsewhere_->solve(p, displacement, energies, x_);
  int refinement = 0;
  for (double energy : energies) {
    converged_ = judge(refinement++, energy, tolerance) || converged_;
  }
  if (!converged_) {
    elsewhere_->refine(more, x_);
    converged_ = judge(refinement, more[0], tolerance);
  }
  if (finite(energies) && finite(more)) return true;
  elsewhere_->forget();
  converged_ = false;
  defect_energy_ = 0;
  return false;
}

}  // namespace sunder::solver
