// SPDX-License-Identifier: Apache-2.0
#include "solver/energy_check.hpp"

#include <algorithm>
#include <cmath>

#include "solver/check_terms.hpp"
#include "solver/load_room.hpp"
#include "solver/stress_bounds.hpp"

namespace sunder::solver {
namespace {

// A bound on the stress error that needs no closer look: what double precision promises along a
// crack, or a tenth of the scene's tolerance.
constexpr double kEnough = 1e-8;
// What a base gives wrong grows with the forces of the damage: they reach 30 times the load as a
// board opens.
constexpr double kAmplified = 100;
// The deferred update stops refining here: its last step gains some digits more.
constexpr double kRefined = 1e-10;
// A displacement so many times that of the last full check (a piece has come loose) needs another.
constexpr double kGrowth = 10;

// How far a direction has to be from the others, or shares grow beyond use.
constexpr double kApart = 1e-3;
// A load this near to the span of those is in it.
constexpr double kInSpan = 1e-12;

double largest_of(std::span<const double> v) {
  double largest = 0;
  for (double x : v) largest = std::max(largest, std::abs(x));
  return largest;
}

}  // namespace

void EnergyCheck::Directions::reserve(const Problem& problem) {
  for (Checked& slot : slots_) solver::reserve(slot.load, problem);
}

/// Whatever the direction of a load, a frame allocates nothing.
EnergyCheck::EnergyCheck(const Problem& problem)
    : problem_(problem),
      stress_of_energy_(solver::largest_stress_of_energy(problem)),
      r_(Directions::kMost, Directions::kMost) {
  reserve(next_.load, problem);
  checks_.reserve(problem);
  others_.reserve(problem);
  const std::size_t rows = most_forces(problem) + problem.gripped_dofs().size();
  q_.reserve(rows * Directions::kMost);
  v_.reserve(rows);
}

void EnergyCheck::checked(const Load& load, const SolveReport& report, double unrefined, int bases,
                          double largest_u, double largest) {
  if (bases != bases_ || !on_same_unknowns(load)) checks_.clear();
  report_ = report;
  bases_ = bases;
  changed_ = false;
  next_.load = load;
  next_.unrefined = unrefined;
  next_.largest_u = largest_u;
  next_.largest = largest;
  add_direction(next_);
}

void EnergyCheck::follow(int bases, const BaseCheck& check) {
  if (bases_ == 0 || bases == bases_) return;
  if (!(check.stress_of_residual > 0) || !on_same_unknowns(check.load) || !shares_of(check.load)) {
    return;
  }
  Checked& next = next_;
  next.load = check.load;
  next.unrefined = check.error;
  next.largest_u = next.largest = 0;
  for (std::size_t i = 0; i < checks_.size(); ++i) {
    const double share = std::abs(shares_[static_cast<Eigen::Index>(i)]);
    next.largest_u += share * checks_[i].largest_u;
    next.largest += share * checks_[i].largest;
  }
  checks_.clear();
  bases_ = bases;
  changed_ = true;
  add_direction(next);
}

bool EnergyCheck::on_same_unknowns(const Load& load) const {
  return !checks_.empty() && load.force_dofs == checks_[0].load.force_dofs &&
         load.displacements.size() == checks_[0].load.displacements.size();
}

EnergyCheck::Column EnergyCheck::column(std::vector<double>& of, Eigen::Index i) const {
  return {of.data() + i * rows_, rows_};
}

/// The load's entries as shares of the last full check's largest force and displacement.
void EnergyCheck::write(const Load& load) {
  const auto forces = static_cast<Eigen::Index>(load.forces.size()),
             grips = static_cast<Eigen::Index>(load.displacements.size());
  rows_ = forces + grips;
  v_.resize(static_cast<std::size_t>(rows_));
  Column v = column(v_);
  v.head(forces) = Eigen::Map<const Eigen::VectorXd>(load.forces.data(), forces) / force_unit_;
  v.tail(grips) =
      Eigen::Map<const Eigen::VectorXd>(load.displacements.data(), grips) / displacement_unit_;
}

/// Takes the first directions out of v_, which go to shares_ (of Q); returns what is left of it.
double EnergyCheck::beyond_span(std::size_t directions) {
  const auto k = static_cast<Eigen::Index>(directions);
  shares_.setZero(k);
  Column v = column(v_);
  const double largest = v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0;
  if (!(largest > 0)) return 0;
  for (Eigen::Index i = 0; i < k; ++i) {
    const Column q = column(q_, i);
    shares_[i] = q.dot(v);
    v -= shares_[i] * q;
  }
  return v.cwiseAbs().maxCoeff() / largest;
}

/// Takes what is left of v_ for the next direction.
void EnergyCheck::take_direction(const Checked& checked) {
  const auto k = static_cast<Eigen::Index>(checks_.size());
  r_.col(k).head(k) = shares_;
  r_(k, k) = column(v_).norm();
  column(q_, k) = column(v_) / r_(k, k);
  checks_.push_back(checked);
}

/// Puts a load before the others, of which it keeps those that add most to the span.
void EnergyCheck::add_direction(const Checked& checked) {
  others_.swap(checks_);
  checks_.clear();
  const double force = largest_of(checked.load.forces),
               displacement = largest_of(checked.load.displacements);
  force_unit_ = force > 0 ? force : 1;
  displacement_unit_ = displacement > 0 ? displacement : 1;
  write(checked.load);
  if (!(beyond_span(0) > 0)) return;  // no load, no direction
  q_.resize(v_.size() * Directions::kMost);
  r_.setZero(Directions::kMost, Directions::kMost);
  take_direction(checked);
  while (checks_.size() < Directions::kMost) {
    double most = 0;
    std::size_t next = 0;
    for (std::size_t i = 0; i < others_.size(); ++i) {
      write(others_[i].load);
      const double beyond = beyond_span(checks_.size());
      if (beyond > most) next = i;
      most = std::max(most, beyond);
    }
    if (!(most >= kApart)) return;
    write(others_[next].load);
    static_cast<void>(beyond_span(checks_.size()));
    take_direction(others_[next]);
  }
}

/// The load as a sum of the directions known; false: it is none.
bool EnergyCheck::shares_of(const Load& load) {
  write(load);
  if (!(beyond_span(checks_.size()) <= kInSpan)) return false;
  const auto k = static_cast<Eigen::Index>(checks_.size());
  r_.topLeftCorner(k, k).triangularView<Eigen::Upper>().solveInPlace(shares_);
  return true;
}

std::optional<EnergyCheck::Expected> EnergyCheck::expected(const Load& load, int bases) {
  if (bases != bases_ || !on_same_unknowns(load) || !shares_of(load)) return std::nullopt;
  Expected expected;
  expected.alone = true;
  const double all = shares_.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < checks_.size(); ++i) {
    const double share = std::abs(shares_[static_cast<Eigen::Index>(i)]);
    if (share <= kInSpan * all) continue;
    expected.alone = expected.alone && i == 0;
    expected.largest_u += share * checks_[i].largest_u;
    expected.largest += share * checks_[i].largest;
    expected.base_error += share * checks_[i].largest * checks_[i].unrefined;
    expected.worst = std::max(expected.worst, checks_[i].unrefined);
  }
  return expected;
}

double EnergyCheck::energy_tolerance(const Expected& expected) const {
  const double e = kRefined * expected.largest / stress_of_energy_;
  return e * e;
}

std::optional<SolveReport> EnergyCheck::known(const Expected& expected, double energy,
                                              double largest_u, double largest) const {
  if (!std::isfinite(largest)) return std::nullopt;  // the load is so large that stress overflows
  SolveReport report = report_;
  report.polished = false;
  report.iterations = 0;
  report.back_solves = 1;
  const double tolerance = problem_.scene().solver.tolerance;
  if (!changed_ && expected.alone) {  // the solution of that check, before it was refined
    report.error = std::max(report.error, expected.worst);
    if (report.error <= tolerance) return report;
  }
  if (!(largest_u <= kGrowth * expected.largest_u)) return std::nullopt;
  if (!(expected.largest <= kGrowth * largest)) return std::nullopt;  // shares that cancel
  report.error = kAmplified * std::max(expected.worst, expected.base_error / largest) +
                 stress_of_energy_ * std::sqrt(std::max(0.0, energy)) / largest;
  if (!(report.error <= std::min(kEnough, tolerance / 10))) return std::nullopt;
  return report;
}

}  // namespace sunder::solver
