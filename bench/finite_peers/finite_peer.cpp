// SPDX-License-Identifier: Apache-2.0
#include "bench/finite_peers/finite_peer.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace sunder::bench {
namespace {

// As in solver/finite_minimiser.cpp and solver/finite_statics.cpp.
constexpr double kArmijo = 1e-4, kEnergyRounding = 1e-13, kLeastPart = 1e-7;
constexpr double kSumRounding = 2e-16, kForceRounding = 1e-14;
constexpr double kMostSeconds = 60;  // of all threads, in a step: on the largest bodies

double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

FinitePeer::FinitePeer(const FiniteSetting& setting, int most)
    : torn_(setting.board, setting.law),
      resting_(torn_.body),
      pass_(resting_.body(), setting.threads),
      load_dofs_(setting.board.load_dofs),
      tolerance_(setting.tolerance),
      newtons_(setting.start.newtons),
      most_(most),
      force_(Eigen::VectorXd::Zero(problem().dof_count())) {
  for (Index e = 0; e < problem().tet_count(); ++e) {
    energy_rounding_ += kSumRounding * problem().small_strain(e).mu * problem().shape(e).volume;
  }
  state_.u = setting.start.u;
  FinitePeer::destroy(setting.board.connected(setting.start.gone));
}

void FinitePeer::destroy(std::span<const Index> elements) {
  torn_.destroy(elements);
  const std::vector<std::uint8_t> before(resting_.out().begin(), resting_.out().end());
  resting_.look();
  std::vector<Index> left;
  for (Index e = 0; e < problem().tet_count(); ++e) {
    if (resting_.out()[e] && !before[e]) left.push_back(e);
  }
  pass_.destroy(left);
  before_.clear();
  body_changed();
}

void FinitePeer::evaluate(State& state) {
  state.f.resize(state.u.size());
  const double energy = pass_.internal_forces(state.u, state.f);
  state.r = -force_;
  double work = 0, square = 0;
  for (std::size_t i = 0; i < state.f.size(); ++i) {
    const Index d = problem().dofs()[i];
    if (d == kNone) {
      square += state.f[i] * state.f[i];
      continue;
    }
    state.r[d] += state.f[i];
    if (frozen()[d]) {
      state.r[d] = 0;
      continue;
    }
    work += force_[d] * state.u[i];
    square += force_[d] * force_[d];
  }
  state.acting = std::sqrt(square);
  state.potential = energy - work;
}

void FinitePeer::move(const State& from, double part, State& to) const {
  to.u = from.u;
  for (std::size_t i = 0; i < to.u.size(); ++i) {
    const Index d = problem().dofs()[i];
    if (d != kNone) to.u[i] += part * du_[d];
  }
}

/// The last step once more, where its energy is less.
void FinitePeer::extrapolate(double newtons) {
  const double times = step_ != 0 ? (newtons - newtons_) / step_ : 0;
  if (before_.empty() || !(times > 0)) return;
  next_.u = state_.u;
  for (std::size_t i = 0; i < next_.u.size(); ++i) {
    next_.u[i] += times * (state_.u[i] - before_[i]);
  }
  evaluate(next_);
  if (next_.potential < state_.potential) std::swap(state_, next_);
}

bool FinitePeer::line_search() {
  const double slope = state_.r.dot(du_);
  if (!(slope < 0)) return false;
  const double rounding = energy_rounding_ + kEnergyRounding * std::abs(state_.potential);
  for (double part = 1; part > kLeastPart; part /= 2) {
    move(state_, part, next_);
    evaluate(next_);
    if (next_.potential <= state_.potential + kArmijo * part * slope + rounding) {
      s_ = part * du_;
      return true;
    }
  }
  return false;
}

FiniteSolved FinitePeer::solve(double newtons) {
  found_ = {};
  const double until = processor_seconds() + kMostSeconds;
  for (Index d : load_dofs_) force_[d] = -newtons / static_cast<double>(load_dofs_.size());
  evaluate(state_);
  const double scale = state_.acting;
  std::vector<double> from = state_.u;
  extrapolate(newtons);
  begin();
  for (;;) {
    const double residual = state_.r.norm() / std::max(scale, state_.acting);
    found_.at_rest = residual <= std::max(tolerance_, kForceRounding);
    if (found_.at_rest || !std::isfinite(residual) || found_.iterations == most_) break;
    if (processor_seconds() > until) break;
    ++found_.iterations;
    if (!direction(state_.u, state_.r, residual, du_)) break;
    for (Index d = 0; d < du_.size(); ++d) {
      if (frozen()[d]) du_[d] = 0;
    }
    if (!line_search()) {
      if (give_way()) continue;
      break;
    }
    y_ = next_.r - state_.r;
    moved(s_, y_);
    std::swap(state_, next_);
  }
  if (newtons != newtons_) step_ = newtons - newtons_;
  newtons_ = newtons;
  before_ = std::move(from);
  return found_;
}

}  // namespace sunder::bench
