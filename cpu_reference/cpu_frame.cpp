// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/cpu_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/instrument_block.hpp"
#include "engine/load_room.hpp"

namespace sunder::cpu_reference {
namespace {

// A full check refines silently down to these stress errors, for the yardstick a tenth of what
// double precision promises for an intact body; only frames over the scene's tolerance count as
// polished.
constexpr double kReferenceError = 1e-10, kDeferredError = 1e-9;
// What double precision promises of a damaged body; of an estimate half of it (at a contrast of 1e4
// a solution was a quarter worse than its residual said).
constexpr double kDamagedError = 1e-8, kEstimated = 5e-9;

}  // namespace

CpuFrame::CpuFrame(const ChosenRoute& chosen, const DamagedBody& body, const IntactBody* intact,
                   InverseRoute& route, FrameFields& fields)
    : chosen_(chosen),
      body_(body),
      intact_(intact),
      route_(route),
      fields_(fields),
      anchors_(engine::anchors_of(problem())) {
  if (by_fields()) fields.keep_forces();
  engine::reserve(load_, problem());
  force_.setZero(problem().dof_count());
  u_ = force_;
  reactions_.assign(problem().gripped_dofs().size(), 0.0);
}

void CpuFrame::set_load(const Load& load) {
  for (Index d : load_.force_dofs) force_[d] = 0;
  load_ = load;
  for (std::size_t i = 0; i < load.forces.size(); ++i) force_[load.force_dofs[i]] = load.forces[i];
}

engine::Precision CpuFrame::precision() const {
  return {by_fields() || !intact_ ? kDeferredError : kReferenceError, kDamagedError, kEstimated};
}

/// The plain routes are what others are measured by.
bool CpuFrame::yardstick() const {
  return (chosen_.route == Route::cg && intact_) ||
         (chosen_.route == Route::inverse && chosen_.update == Update::eager);
}

int CpuFrame::solve(double enough, bool) {
  route().set_enough(enough);
  const int iterations = route().solve(load_, force_, u_).iterations;
  route().complete(u_);
  look_at();
  return iterations;
}

/// Residual f - K u and reactions of the solution, and its largest stress.
void CpuFrame::look_at() {
  if (by_fields()) {
    hand_out();
    fields_.forces(product_);
  } else {
    body_.apply(u_, product_);
    largest_ = body_.largest_stress(u_);
  }
  r_ = force_ - product_;
  const auto gripped = problem().gripped_dofs();
  load_squared_ = force_.squaredNorm();
  for (std::size_t g = 0; g < gripped.size(); ++g) {
    reactions_[g] = -r_[gripped[g]];  // what the grip adds to the applied force
    load_squared_ += reactions_[g] * reactions_[g];
    r_[gripped[g]] = 0;
  }
}

engine::Balance CpuFrame::balance() const {
  return {r_.norm(), load_squared_, u_.size() > 0 ? u_.cwiseAbs().maxCoeff() : 0.0, largest_};
}

/// Displacement at all nodes, and its stress.
void CpuFrame::hand_out() {
  if (const auto largest = fields_.take(u_)) largest_ = *largest;
}

engine::FrameDevice::Correction CpuFrame::correct() {
  const Applied applied = route().apply(r_, du_);
  if (!applied.converged) return {std::numeric_limits<double>::infinity(), applied.iterations};
  return {by_fields() ? fields_.largest_stress(du_) : body_.largest_stress(du_),
          applied.iterations};
}

void CpuFrame::add_correction() {
  u_ += du_;
  look_at();
}

bool CpuFrame::fall_back(bool on) {
  if (chosen_.route == Route::cg || !intact_) return false;
  cg_ = on ? conjugate_gradient_route(body_, *intact_) : nullptr;
  return true;
}

engine::FrameDevice::OnRegion CpuFrame::solve_region(double enough) {
  route_.set_enough(enough);
  route_.solve(load_, force_, u_);
  const OnRegion found = on_region();
  const auto gripped = problem().gripped_dofs();
  for (std::size_t g = 0; g < gripped.size(); ++g) {
    reactions_[g] = grip_force(g) - anchors_[g] * u_[gripped[g]];  // the anchor's share
  }
  return found;
}

engine::FrameDevice::OnRegion CpuFrame::on_region() {
  hand_out();
  OnRegion found;
  for (Index d : fields_.region()->dofs) {
    found.largest_u = std::max(found.largest_u, std::abs(u_[d]));
  }
  found.largest_stress = largest_;
  return found;
}

void CpuFrame::publish(bool everywhere) {
  if (condensed() && everywhere) {
    fields_.publish_everywhere(u_);
    return;
  }
  if (!condensed() && !by_fields()) hand_out();
  fields_.publish(route_);
}

double CpuFrame::grip_force(std::size_t g) const {
  return route_.deferred()->grip_forces()[static_cast<Eigen::Index>(g)];
}

}  // namespace sunder::cpu_reference
