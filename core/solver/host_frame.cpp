// SPDX-License-Identifier: Apache-2.0
#include "solver/host_frame.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "solver/load_room.hpp"

namespace sunder::solver {
namespace {

using Clock = std::chrono::steady_clock;

// A full check refines silently down to these stress errors, for a yardstick and a region, whose
// next frames rely on it, a tenth of what double precision promises for an intact body; only frames
// over the scene's tolerance count as polished.
constexpr double kReferenceError = 1e-10, kDeferredError = 1e-9;
// What double precision promises of a damaged body; of an estimate half of it (at a contrast of 1e4
// a solution was a quarter worse than its residual said).
constexpr double kDamagedError = 1e-8, kEstimated = 5e-9;

}  // namespace

HostFrame::HostFrame(const fem::DamagedBody& body, InverseRoute& route, HostFields& fields,
                     bool yardstick, MakeRoute fall_back)
    : body_(body),
      route_(route),
      fields_(fields),
      yardstick_(yardstick),
      fall_back_(std::move(fall_back)),
      anchors_(problem()) {
  reserve(load_, problem());
  force_.setZero(problem().dof_count());
  u_ = force_;
  reactions_.assign(problem().gripped_dofs().size(), 0.0);
}

void HostFrame::set_load(const Load& load) {
  make_room_for_offsets();
  for (Index d : load_.force_dofs) force_[d] = 0;
  load_ = load;
  for (std::size_t i = 0; i < load.forces.size(); ++i) force_[load.force_dofs[i]] = load.forces[i];
}

void HostFrame::restore(const State& state) {
  set_load(state.load);
  u_ = state.u;
  reactions_ = state.reactions;
  load_squared_ = state.load_squared;
  largest_ = state.largest;
}

void HostFrame::follow_grips(std::span<const Index> before) {
  if (fields_.region()) read_grips(before);
  std::vector<double> displacements, reactions;
  for (Index d : gripped()) {
    const auto was = static_cast<std::size_t>(std::ranges::find(before, d) - before.begin());
    const bool stays = was < before.size();
    displacements.push_back(stays && was < load_.displacements.size() ? load_.displacements[was]
                                                                      : u_[d]);
    reactions.push_back(stays ? reactions_[was] : 0.0);
  }
  load_.displacements = std::move(displacements);
  reactions_ = std::move(reactions);
}

/// Where those are that nobody held before: a region's frames leave u_ as it was beyond it.
void HostFrame::read_grips(std::span<const Index> before) {
  std::vector<Index> beyond, nodes;
  for (Index d : gripped()) {
    if (std::ranges::find(before, d) == before.end() &&
        !std::ranges::binary_search(fields_.region()->dofs, d)) {
      beyond.push_back(d);
    }
  }
  if (beyond.empty()) return;
  std::ranges::sort(beyond);
  for (Index n = 0; n < problem().node_count(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::ranges::binary_search(beyond, problem().dof(n, axis))) continue;
      nodes.push_back(n);
      break;
    }
  }
  std::vector<Vec3> displacement(nodes.size());
  fields_.read_displacement(nodes, displacement);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem().dof(nodes[i], axis);
      if (d != kNone) u_[d] = displacement[i][axis];
    }
  }
}

/// Offsets of new nodes bear no load.
void HostFrame::make_room_for_offsets() {
  offsets_.follow(body_.forms());
  const Eigen::Index all = problem().dof_count() + offsets_.count(), before = force_.size();
  if (all == before) return;
  force_.conservativeResize(all);
  if (all > before) force_.tail(all - before).setZero();
}

Precision HostFrame::precision() const {
  return {yardstick_ || condensed() ? kReferenceError : kDeferredError, kDamagedError, kEstimated};
}

int HostFrame::solve(double energy_tolerance, Residual) {
  make_room_for_offsets();
  route().set_energy_tolerance(energy_tolerance);
  const int iterations = route().solve(load_, force_, u_).iterations;
  const auto added = condensed() && route().drifts() ? refine() : std::nullopt;
  route().complete(u_);
  compute_residual();
  mended_ = added ? *added / largest_ : 0;
  return iterations;
}

/// Residual f - K u and reactions of the solution, and its largest stress.
void HostFrame::compute_residual() {
  if (fields_.has_forces()) {
    compute_stress();
    fields_.forces(product_);
  } else {
    body_.apply(u_, product_);
    largest_ = body_.largest_stress(u_);
  }
  r_ = force_ - product_;
  load_squared_ = force_.squaredNorm();
  for (std::size_t g = 0; g < gripped().size(); ++g) {
    const Index d = gripped()[g];
    reactions_[g] = -r_[d];  // what the grip adds to the applied force
    load_squared_ += reactions_[g] * reactions_[g];
    r_[d] = 0;
  }
}

Balance HostFrame::balance() const {
  return {r_.norm(), load_squared_, u_.size() > 0 ? u_.cwiseAbs().maxCoeff() : 0.0, largest_};
}

/// Displacement at all nodes, and its stress.
void HostFrame::compute_stress() {
  const auto start = Clock::now();
  const auto largest = fields_.take(u_);
  if (!largest) return;  // left out
  largest_ = *largest;
  stress_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

FrameDevice::Correction HostFrame::correct(bool add) {
  const Applied applied = route().apply(r_, du_);
  if (!applied.converged) return {std::numeric_limits<double>::infinity(), applied.iterations};
  const double stress =
      fields_.has_forces() ? fields_.largest_stress(du_) : body_.largest_stress(du_);
  if (add) add_correction();
  return {stress, applied.iterations};
}

void HostFrame::add_correction() {
  u_ += du_;
  compute_residual();
}

bool HostFrame::fall_back(bool on) {
  if (!fall_back_ || body_.forms().node_count() > problem().node_count()) return false;
  other_ = on ? fall_back_() : nullptr;
  return true;
}

FrameDevice::OnRegion HostFrame::solve_region(double energy_tolerance) {
  route_.set_energy_tolerance(energy_tolerance);
  route_.solve(load_, force_, u_);
  const OnRegion found = on_region();
  find_reactions();
  return found;
}

/// By the forces of the route's grips.
void HostFrame::find_reactions() {
  const auto anchors = anchors_.of(gripped());
  for (std::size_t g = 0; g < gripped().size(); ++g) {
    reactions_[g] = grip_force(g) - anchors[g] * u_[gripped()[g]];  // the anchor's share
  }
}

/// On the region; the largest stress of what that has added.
std::optional<double> HostFrame::refine() {
  if (du_.size() != u_.size()) du_.setZero(u_.size());
  if (!route_.refine(load_, u_, du_)) return std::nullopt;
  return body_.largest_stress(du_, fields_.region()->elements);
}

std::optional<FrameDevice::RefinedOnRegion> HostFrame::refine_region() {
  const auto stress = refine();
  if (!stress) return std::nullopt;
  const OnRegion found = on_region();
  find_reactions();
  return RefinedOnRegion{*stress, found};
}

FrameDevice::OnRegion HostFrame::on_region() {
  compute_stress();
  OnRegion found;
  for (Index d : route_.known()) {  // what has come loose beyond the region among them
    found.largest_u = std::max(found.largest_u, std::abs(u_[d]));
  }
  found.largest_stress = largest_;
  return found;
}

double HostFrame::grip_force(std::size_t g) const { return route_.deferred()->grip_force(g); }

}  // namespace sunder::solver
