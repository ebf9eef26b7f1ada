// SPDX-License-Identifier: Apache-2.0
// A solution by the small matrices over the base: the forces of damage and grips, and what refines
// them.
#include <algorithm>
#include <cmath>

#include "linear_algebra/symmetric_product.hpp"
#include "solver/deferred.hpp"

namespace sunder::solver {
namespace {

constexpr int kRefinements = 4;

/// y = S x for a symmetric S of which the leading k rows and columns alone are not 0; n entries of
/// x and y.
void multiply(const linear_algebra::RowMajor& s, Eigen::Index n, Eigen::Index k,
              const Eigen::VectorXd& x, Eigen::VectorXd& y) {
  linear_algebra::symmetric_product(s.data(), s.outerStride(), k, x.data(), y.data());
  y.segment(k, n - k).setZero();
}

}  // namespace

const Eigen::VectorXd& Deferred::coefficients(const Forces& forces,
                                              std::span<const double> displacement,
                                              double energy_tolerance) {
  const Eigen::VectorXd& p = base_->load(on_body(forces));
  converged_ = before_.empty();
  defect_energy_ = 0;
  if (!converged_ && solve_elsewhere(p, displacement, energy_tolerance)) return x_;
  start(p, displacement);
  for (int pass = 0; pass < kRefinements && !converged_; ++pass) {
    converged_ = judge(pass, refine(p, displacement), energy_tolerance);
  }
  return x_;
}

/// Takes what a solution lacked before a refinement; whether that was the last one.
bool Deferred::judge(int refinement, double energy, double tolerance) {
  // Where defect_energy() is what a solution is judged by: so many times the tolerance may lack of
  // it, by rounding alone.
  constexpr double kOfRounding = 400;
  const double before = defect_energy_;
  defect_energy_ = energy;
  if (energy <= tolerance) return true;
  if (refinement == 0) return false;
  // Another would change nothing: rounding has the word already, or from here on.
  const bool stalls = !(energy < before / 4), next_is_under = by_energy_ &&
                                                              energy <= kOfRounding * tolerance &&
                                                              energy * energy <= tolerance * before;
  return stalls || next_is_under;
}

void Deferred::solve(const Forces& forces, std::span<const double> displacement, Eigen::VectorXd& u,
                     double energy_tolerance) {
  base_->expand(coefficients(forces, displacement, energy_tolerance), u);
  hold(displacement, u);
}

double Deferred::forces() const {
  double squared = 0;
  for (Index column : column_) squared += x_[column] * x_[column];
  return std::sqrt(squared);
}

void Deferred::hold(std::span<const double> displacement, Eigen::VectorXd& u) const {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    u[held_[i].dof] = displacement.empty() ? 0.0 : displacement[i];
  }
}

const Eigen::VectorXd& Deferred::refine_at(const Eigen::VectorXd& u_in_b,
                                           std::span<const double> displacement) {
  v_.head(count()) = u_in_b.head(count());
  defect_energy_ = refine_at_v(displacement);
  if (held_.empty() || !border_.empty()) return x_;
  // With the grips held: less L^-1 (E + M G_G)^T g, g = G lack, by itself.
  for (std::size_t i = 0; i < held_.size(); ++i) {
    at_held_[static_cast<Eigen::Index>(i)] += gx_[held_[i].column];
  }
  grip_block_.matrixL().solveInPlace(at_held_);
  defect_energy_ = std::max(0.0, defect_energy_ - at_held_.squaredNorm());
  return x_;
}

void Deferred::correct(const Forces& residual, Eigen::VectorXd& du) {
  base_->expand(correct(base_->load(on_body(residual))), du);
  for (const Held& held : held_) du[held.dof] = 0;
}

const Eigen::VectorXd& Deferred::correction_coefficients(const Eigen::VectorXd& projection) {
  border_.take_none();
  return correct(projection);
}

const Eigen::VectorXd& Deferred::correct(const Eigen::VectorXd& projection) {
  start(projection, {});
  return x_;
}

/// The forces but those on new unknowns, which the border takes.
Forces Deferred::on_body(const Forces& forces) {
  return border_.empty() ? forces : border_.take(forces, base_->size());
}

/// x = M p and what the grips add: A^-1 as it is stored.
void Deferred::start(const Eigen::VectorXd& p, std::span<const double> displacement) {
  const Eigen::Index n = count();
  for (std::size_t i = 0; i < held_.size(); ++i) {
    forces_[static_cast<Eigen::Index>(i)] = -p[held_[i].column];
  }
  if (!border_.empty()) {
    multiply(m_, n, changed_, p, x_);
    border_.start(p, x_);
    subtract_at_grips(x_, forces_);
    add_grips(displacement);
    return;
  }
  gx_.head(n) = p.head(n);
  if (!held_.empty()) {
    forces_.noalias() -= under_grips_.leftCols(n) * p.head(n);
    solve_grips(displacement);
    add_of_grips(gx_);
  }
  multiply(m_, n, changed_, gx_, x_);
  for (std::size_t i = 0; i < held_.size(); ++i) {
    x_[held_[i].column] += forces_[static_cast<Eigen::Index>(i)];
  }
}

/// One step towards x = D B^T u, u_G = displacement; returns the energy of what was lacking.
double Deferred::refine(const Eigen::VectorXd& p, std::span<const double> displacement) {
  const Eigen::Index n = count();
  multiply(compliance_, n, n, x_, v_);
  v_.head(n) += p.head(n);  // B^T u
  return refine_at_v(displacement);
}

/// The same with v_ = B^T u at hand.
double Deferred::refine_at_v(std::span<const double> displacement) {
  const Eigen::Index n = count();
  // D B^T u - x
  v_.segment(n, linear_algebra::padded(n) - n).setZero();
  filled_.multiply(d_.data(), d_.outerStride(), n, v_.data(), lack_.data());
  lack_.head(n) -= x_.head(n);
  for (Index d : units_) lack_[unit_[d]] = 0;  // where only grips act
  if (!border_.empty()) border_.add_lack(v_, lack_);
  multiply(compliance_, n, n, lack_, gx_);
  for (std::size_t i = 0; i < held_.size(); ++i) {
    forces_[static_cast<Eigen::Index>(i)] = -v_[held_[i].column] - gx_[held_[i].column];
  }
  return border_.empty() ? refine_by_base(displacement) : refine_with_border(displacement);
}

/// The grips' forces are known before M is multiplied: M has the lack and them at once.
double Deferred::refine_by_base(std::span<const double> displacement) {
  const Eigen::Index n = count();
  double of_grips = 0;  // g^T M G_G forces, g = G lack
  v_.head(n) = gx_.head(n);
  if (!held_.empty()) {
    at_held_.noalias() = under_grips_.leftCols(n) * gx_.head(n);
    forces_ -= at_held_;
    solve_grips(displacement);
    of_grips = at_held_.dot(forces_);
    add_of_grips(v_);
  }
  multiply(m_, n, changed_, v_, mgx_);
  const double energy = lack_.head(n).dot(gx_.head(n)) + gx_.head(n).dot(mgx_.head(n)) - of_grips;
  x_.head(n) += lack_.head(n);
  x_.head(n) += mgx_.head(n);
  for (std::size_t i = 0; i < held_.size(); ++i) {
    x_[held_[i].column] += forces_[static_cast<Eigen::Index>(i)];
  }
  return energy;
}

/// With new unknowns, which lack something too.
double Deferred::refine_with_border(std::span<const double> displacement) {
  const Eigen::Index n = count();
  multiply(m_, n, changed_, gx_, mgx_);
  double energy = lack_.head(n).dot(gx_.head(n)) + gx_.head(n).dot(mgx_.head(n));
  x_.head(n) += lack_.head(n);
  x_.head(n) += mgx_.head(n);
  moved_.setZero(grips());
  energy += border_.correct(gx_, x_, moved_);
  forces_ -= moved_;
  subtract_at_grips(mgx_, forces_);
  add_grips(displacement);
  return energy;
}

/// Adds the grips' forces that move u_G, which is at -forces_, to the displacement.
void Deferred::add_grips(std::span<const double> displacement) {
  if (held_.empty()) return;
  const Eigen::Index n = count();
  solve_grips(displacement);
  gx_.head(n).setZero();
  add_of_grips(gx_);
  multiply(m_, n, changed_, gx_, mgx_);
  x_.head(n) += mgx_.head(n);
  for (std::size_t i = 0; i < held_.size(); ++i) {
    x_[held_[i].column] += forces_[static_cast<Eigen::Index>(i)];
  }
  border_.follow_grips(forces_, x_);
}

/// forces_, the negative of u_G, becomes the forces that move it to the displacement (empty: 0).
void Deferred::solve_grips(std::span<const double> displacement) {
  for (std::size_t i = 0; i < held_.size() && !displacement.empty(); ++i) {
    forces_[static_cast<Eigen::Index>(i)] += displacement[i];
  }
  grip_block_.solveInPlace(forces_);
}

/// Adds G_G forces_: what they do in the base.
void Deferred::add_of_grips(Eigen::VectorXd& to) const {
  const Eigen::Index n = count();
  for (std::size_t i = 0; i < held_.size(); ++i) {
    to.head(n) += forces_[static_cast<Eigen::Index>(i)] *
                  compliance_.row(held_[i].column).head(n).transpose();
  }
}

}  // namespace sunder::solver
