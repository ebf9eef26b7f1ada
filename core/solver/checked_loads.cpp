// SPDX-License-Identifier: Apache-2.0
#include "solver/checked_loads.hpp"

#include <algorithm>
#include <cmath>

#include "solver/load_room.hpp"

namespace sunder::solver {
namespace {

// How far a direction has to be from the others, or shares grow beyond use.
constexpr double kApart = 1e-3;
// A load this near to the span of those is in it.
constexpr double kInSpan = 1e-12;
// Entries of all columns together: a load on every unknown of a large body (gravity) leaves room
// for fewer directions.
constexpr std::size_t kRoom = 1'200'000, kFewest = 2;

}  // namespace

CheckedLoads::CheckedLoads(const Problem& problem) : r_(kMost, kMost) {
  const std::size_t dofs = most_forces(problem), rows = dofs + problem.gripped_dofs().size();
  most_ = std::clamp(kRoom / std::max<std::size_t>(rows, 1), kFewest, kMost);
  dofs_.reserve(dofs);
  loads_.reserve(rows * most_);
  q_.reserve(rows * most_);
  v_.reserve(rows);
}

void CheckedLoads::checked(const Load& load, const Found& found, int bases) {
  if (bases != bases_ || !takes(load)) begin(load);
  bases_ = bases;
  const std::size_t slot = free_slot();
  write(load);
  column(loads_, slot) = column(v_);
  found_[slot] = found;
  sort_in(slot);
}

/// Another base, or other unknowns: nothing is known.
void CheckedLoads::begin(const Load& load) {
  size_ = 0;
  dofs_.assign(load.force_dofs.begin(), load.force_dofs.end());
  grips_ = load.displacements.size();
  rows_ = static_cast<Eigen::Index>(dofs_.size() + grips_);
  loads_.resize(static_cast<std::size_t>(rows_) * most_);
  q_.resize(loads_.size());
}

bool CheckedLoads::follow(int bases, const BaseCheck& check) {
  if (bases_ == 0 || bases == bases_ || !(check.stress_of_residual > 0)) return false;
  const auto sum = takes(check.load) ? sum_of(check.load) : std::nullopt;
  if (!sum) return false;
  checked(check.load,
          {check.error, check.stress_of_residual, sum->largest_u, sum->largest_stress, 0, 1},
          bases);
  return true;
}

void CheckedLoads::event() {
  for (Found& of : found_) ++of.events;
}

std::optional<CheckedLoads::Sum> CheckedLoads::expected(const Load& load, int bases) {
  if (bases != bases_ || !takes(load)) return std::nullopt;
  return sum_of(load);
}

bool CheckedLoads::takes(const Load& load) const {
  return size_ > 0 && load.displacements.size() == grips_ && load.force_dofs == dofs_;
}

CheckedLoads::Column CheckedLoads::column(std::vector<double>& of, std::size_t i) const {
  return {of.data() + static_cast<Eigen::Index>(i) * rows_, rows_};
}

void CheckedLoads::write(const Load& load) {
  v_.assign(load.forces.begin(), load.forces.end());
  v_.insert(v_.end(), load.displacements.begin(), load.displacements.end());
}

/// v_ <- a load known.
void CheckedLoads::bring(std::size_t slot) {
  const Column load = column(loads_, slot);
  v_.assign(load.begin(), load.end());
}

/// Takes the columns out of v_, by the units, which go to shares_ (of Q); returns what is left.
double CheckedLoads::beyond_span() {
  const auto k = static_cast<Eigen::Index>(size_);
  shares_.setZero(k);
  Column v = column(v_);
  v.head(rows_ - static_cast<Eigen::Index>(grips_)) /= force_unit_;
  v.tail(static_cast<Eigen::Index>(grips_)) /= displacement_unit_;
  const double largest = v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0;
  if (!(largest > 0)) return 0;
  for (Eigen::Index i = 0; i < k; ++i) {
    const Column q = column(q_, static_cast<std::size_t>(i));
    shares_[i] = q.dot(v);
    v -= shares_[i] * q;
  }
  return v.cwiseAbs().maxCoeff() / largest;
}

/// What is left of v_ is the next column.
void CheckedLoads::take(std::size_t slot) {
  const auto k = static_cast<Eigen::Index>(size_);
  r_.col(k).head(k) = shares_;
  r_(k, k) = column(v_).norm();
  column(q_, size_) = column(v_) / r_(k, k);
  order_[size_++] = slot;
}

/// One without a load that is known; else that of the load that adds least.
std::size_t CheckedLoads::free_slot() const {
  if (size_ == most_) return order_[size_ - 1];
  std::size_t slot = 0;
  while (std::find(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(size_), slot) !=
         order_.begin() + static_cast<std::ptrdiff_t>(size_)) {
    ++slot;
  }
  return slot;
}

/// Columns anew: the newest load, then of the others always the one that adds most, those that are
/// older than the last event at the end.
void CheckedLoads::sort_in(std::size_t newest) {
  std::array<std::size_t, kMost> others{};
  std::size_t left = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    if (order_[i] != newest) others[left++] = order_[i];
  }
  size_ = 0;
  bring(newest);
  const Column v = column(v_);
  const auto grips = static_cast<Eigen::Index>(grips_);
  const double force = rows_ > grips ? v.head(rows_ - grips).cwiseAbs().maxCoeff() : 0.0,
               displacement = grips > 0 ? v.tail(grips).cwiseAbs().maxCoeff() : 0.0;
  force_unit_ = force > 0 ? force : 1;
  displacement_unit_ = displacement > 0 ? displacement : 1;
  if (!(beyond_span() > 0)) return;  // no load, no direction
  r_.setZero(kMost, kMost);
  take(newest);
  for (const bool fresh : {true, false}) {
    for (;;) {
      double most = 0;
      std::size_t next = 0;
      for (std::size_t i = 0; i < left; ++i) {
        if ((found_[others[i]].events == 0) != fresh) continue;
        bring(others[i]);
        const double beyond = beyond_span();
        if (beyond > most) next = i;
        most = std::max(most, beyond);
      }
      if (!(most >= kApart)) break;
      bring(others[next]);
      static_cast<void>(beyond_span());
      take(others[next]);
      others[next] = others[--left];
    }
  }
}

std::optional<CheckedLoads::Sum> CheckedLoads::sum_of(const Load& load) {
  write(load);
  if (!(beyond_span() <= kInSpan)) return std::nullopt;
  const auto k = static_cast<Eigen::Index>(size_);
  r_.topLeftCorner(k, k).triangularView<Eigen::Upper>().solveInPlace(shares_);
  Sum sum;
  sum.alone = true;
  bool forces_known = true;
  const double all = shares_.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < size_; ++i) {
    const double share = std::abs(shares_[static_cast<Eigen::Index>(i)]);
    if (share <= kInSpan * all) continue;
    const Found& of = found_[order_[i]];
    sum.alone = sum.alone && i == 0;
    sum.events = std::max(sum.events, of.events);
    sum.largest_u += share * of.largest_u;
    sum.largest_stress += share * of.largest_stress;
    sum.stress_error += share * of.largest_stress * of.error;
    sum.forces += share * of.forces;
    forces_known = forces_known && of.forces > 0;
    sum.error = std::max(sum.error, of.error);
    sum.stress_of_residual = std::max(sum.stress_of_residual, of.stress_of_residual);
  }
  if (!forces_known) sum.forces = 0;
  return sum;
}

}  // namespace sunder::solver
