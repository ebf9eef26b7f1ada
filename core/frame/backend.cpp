// SPDX-License-Identifier: Apache-2.0
#include "sunder/backend.hpp"

#include <algorithm>
#include <cmath>

#include "body/damaged_body.hpp"
#include "sunder/error.hpp"

namespace sunder {

Backend::Backend(std::shared_ptr<const Problem> problem, Needs needs)
    : problem_(std::move(problem)), needs_(std::move(needs)) {
  if (!problem_) throw UsageError("a backend needs a problem");
  damaged_body_ = std::make_unique<fem::DamagedBody>(problem_);
  if (!needs_.damage) return;
  damaged_body_->reserve();
  sorted_.reserve(std::min(destroyed().size(), std::size_t{4096}));
}

Backend::~Backend() = default;

std::span<const std::uint8_t> Backend::destroyed() const { return damaged_body_->destroyed(); }

void Backend::require(bool condition, const char* what) const {
  if (!condition) throw UsageError(what);
}

void Backend::set_load(const Load& load) {
  require(load.forces.size() == load.force_dofs.size(), "a load needs one force per dof");
  require(load.displacements.size() == gripped_dofs().size(),
          "a load needs one displacement per gripped dof");
  for (std::size_t i = 0; i < load.force_dofs.size(); ++i) {
    const Index d = load.force_dofs[i];
    require(d >= 0 && d < problem_->dof_count(), "a load's dof lies outside the problem");
    require(i == 0 || load.force_dofs[i - 1] < d, "a load's dofs must ascend, each once");
    require(std::isfinite(load.forces[i]), "a load's forces must be finite");
  }
  for (double d : load.displacements) {
    require(std::isfinite(d), "a load's displacements must be finite");
  }
  do_set_load(load);
  stage_ = Stage::loaded;
}

SolveReport Backend::solve() {
  require(stage_ != Stage::created, "there is nothing to solve before a load is set");
  const SolveReport report = do_solve();
  stage_ = Stage::solved;
  return report;
}

SolveReport Backend::advance(double dt) {
  require(problem_->moves(), "a step of time needs a scene in motion");
  require(stage_ != Stage::created, "there is nothing to advance to before a load is set");
  require(dt > 0 && std::isfinite(dt), "a step of time must be finite and above 0 s");
  const SolveReport report = do_advance(dt);
  stage_ = Stage::solved;
  return report;
}

MotionState Backend::motion() const {
  require(problem_->moves(), "the state of motion needs a scene in motion");
  return do_motion();
}

void Backend::read_velocity(std::span<double> velocity) const {
  require_motion(velocity);
  do_read_velocity(velocity);
}

void Backend::set_velocity(std::span<const double> velocity) {
  require_motion(velocity);
  for (double v : velocity) require(std::isfinite(v), "velocities must be finite");
  do_set_velocity(velocity);
}

Vec3 Backend::held_beside() const {
  require(problem_->moves(), "what supports hold beside internal forces needs a scene in motion");
  return do_held_beside();
}

void Backend::require_motion(std::span<const double> velocity) const {
  require(problem_->moves(), "velocities need a scene in motion");
  require(velocity.size() == 3 * problem_->mesh().nodes.size(),
          "the velocity needs 3 values per node");
}

SolveReport Backend::do_advance(double) {
  throw UsageError("backend " + info().backend + " does not move bodies");
}
void Backend::do_read_velocity(std::span<double> velocity) const {
  std::ranges::fill(velocity, 0.0);
}
void Backend::do_set_velocity(std::span<const double>) {
  throw UsageError("backend " + info().backend + " does not move bodies");
}

StressSummary Backend::stress() {
  require(needs_.stress, "stress was left out of this backend's needs");
  require(stage_ == Stage::solved || stage_ == Stage::stressed,
          "there is no stress before the first solution");
  const StressSummary summary = do_stress();
  stage_ = Stage::stressed;
  stress_known_ = true;
  return summary;
}

Deformation Backend::deformation() {
  require(stage_ == Stage::stressed, "there is no deformation before the stress of a solution");
  return do_deformation();
}

void Backend::cut_off(std::span<const Index> elements) {
  require(needs_.damage, "damage was left out of this backend's needs");
  for (Index e : elements) {
    require(e >= 0 && e < problem_->tet_count(),
            "an element that is cut off lies outside the mesh");
  }
  if (needs_.stress && !elements.empty()) do_cut_off(elements);
}

void Backend::destroy(std::span<const Index> elements) {
  require(needs_.damage, "damage was left out of this backend's needs");
  if (elements.empty()) return;
  std::vector<Index>& sorted = sorted_;  // kept: a frame allocates nothing
  sorted.assign(elements.begin(), elements.end());
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    require(sorted[i] >= 0 && sorted[i] < problem_->tet_count(),
            "an element to be destroyed lies outside the mesh");
    require(i == 0 || sorted[i] != sorted[i - 1], "an element to be destroyed is named twice");
    require(!destroyed()[sorted[i]], "an element to be destroyed is destroyed already");
  }
  damaged_body_->destroy(elements);
  do_destroy(elements);
  // In motion what has gone shows in the next step; the state is still the one before it.
  if (stage_ != Stage::created && !problem_->moves()) stage_ = Stage::loaded;
}

void Backend::change(const fem::Change& change) {
  require(needs_.split, "new nodes were left out of this backend's needs");
  require(change.leave.empty(), "elements that leave are destroyed, not changed");
  if (change.come.empty() && change.ties.empty()) return;
  if (!damaged_body_->change(change)) {
    throw NumericalError("a change would let a part of the body move without strain");
  }
  do_change(change);
  if (stage_ != Stage::created && !problem_->moves()) stage_ = Stage::loaded;
}

std::span<const Index> Backend::gripped_dofs() const { return damaged_body_->forms().gripped(); }

std::span<const Index> Backend::own_gripped_dofs() const {
  return damaged_body_->forms().own_gripped();
}

std::string Backend::why_no_grasp() const {
  const BackendInfo is = info();
  return "backend " + is.backend + " by route " + is.route +
         " holds no more nodes than the scene's grips; take backend cpu";
}

void Backend::grasp(std::span<const Index> dofs) {
  require(needs_.damage, "grips of a host were left out of this backend's needs");
  require(why_no_grasp().empty(), "this backend takes no other grips");
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    require(dofs[i] >= 0 && dofs[i] < problem_->dof_count(), "a dof to grasp is no unknown");
    require(std::ranges::find(gripped_dofs(), dofs[i]) == gripped_dofs().end() &&
                std::find(dofs.begin(), dofs.begin() + static_cast<std::ptrdiff_t>(i), dofs[i]) ==
                    dofs.begin() + static_cast<std::ptrdiff_t>(i),
            "a dof to grasp is gripped already");
  }
  change_grips(dofs, {});
}

void Backend::release(std::span<const Index> dofs) {
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    require(std::ranges::find(gripped_dofs(), dofs[i]) != gripped_dofs().end() &&
                std::find(dofs.begin(), dofs.begin() + static_cast<std::ptrdiff_t>(i), dofs[i]) ==
                    dofs.begin() + static_cast<std::ptrdiff_t>(i),
            "a dof to let go is not gripped");
  }
  if (dofs.empty()) return;
  require(needs_.damage && why_no_grasp().empty(), "this backend lets no grips go");
  change_grips({}, dofs);
}

void Backend::change_grips(std::span<const Index> grasp, std::span<const Index> release) {
  if (grasp.empty() && release.empty()) return;
  const std::vector<Index> before(gripped_dofs().begin(), gripped_dofs().end());
  damaged_body_->grip(grasp, release);
  do_grip({grasp, release, before});
}

void Backend::do_grip(const GripChange&) { throw UsageError(why_no_grasp()); }

std::shared_ptr<const BackendState> Backend::save() const {
  std::unique_ptr<BackendState> state = do_save();
  if (!state) return nullptr;
  state->owner_ = self_;
  state->events_ = damaged_body_->events();
  state->stage_ = static_cast<int>(stage_);
  state->stress_known_ = stress_known_;
  return state;
}

bool Backend::restore(const BackendState& state) {
  if (state.owner_.lock() != self_ || state.events_ > damaged_body_->events()) return false;
  if (!do_restore(state, state.events_)) return false;
  stage_ = static_cast<Stage>(state.stage_);
  stress_known_ = state.stress_known_;
  return true;
}

void Backend::take_body_back(std::size_t events) { damaged_body_->take_back(events); }

const fem::Pools* Backend::pools() const { return damaged_body_->forms().pools(); }

Index Backend::node_count() const { return damaged_body_->forms().node_count(); }

void Backend::do_change(const fem::Change&) {
  throw UsageError("backend " + info().backend + " does not split nodes");
}

void Backend::prepare(std::span<const Index> elements) {
  require(needs_.damage, "damage was left out of this backend's needs");
  for (Index e : elements) {
    require(e >= 0 && e < problem_->tet_count(), "an element to prepare for lies outside the mesh");
  }
  do_prepare(elements);
}

void Backend::exclude_candidates(std::span<const Index> elements) {
  require(needs_.yield, "the yield summary was left out of this backend's needs");
  for (Index e : elements) {
    require(e >= 0 && e < problem_->tet_count(), "an element to exclude lies outside the mesh");
  }
  do_exclude_candidates(elements);
}

void Backend::solve_pristine(const Load& load, std::span<double> displacement) {
  require(needs_.pristine, "the intact body's field was left out of this backend's needs");
  require(displacement.size() == 3 * problem_->mesh().nodes.size(),
          "the intact body's displacement needs 3 values per node");
  require(load.displacements.size() == gripped_dofs().size() &&
              load.forces.size() == load.force_dofs.size(),
          "the load does not fit the problem");
  do_solve_pristine(load, displacement);
}

void Backend::read_displacement(std::span<double> displacement) const {
  require(stage_ != Stage::created, "there is no displacement before the first solution");
  require(displacement.size() == 3 * problem_->mesh().nodes.size(),
          "the displacement needs 3 values per node");
  do_read_displacement(displacement);
}

void Backend::read_displacement(std::span<const Index> nodes, std::span<Vec3> displacement) const {
  require(stage_ != Stage::created, "there is no displacement before the first solution");
  require(nodes.size() == displacement.size(), "one displacement per node");
  for (Index n : nodes) require(n >= 0 && n < node_count(), "a node outside the body");
  do_read_displacement(nodes, displacement);
}

void Backend::read_stress(std::span<Voigt> stress) const {
  require(stress_known_, "there is no stress before it is computed");
  require(stress.size() == problem_->mesh().tets.size(), "one stress per element");
  do_read_stress(stress);
}

Voigt Backend::read_stress(Index element) const {
  require(stress_known_, "there is no stress before it is computed");
  require(element >= 0 && element < problem_->tet_count(), "an element outside the mesh");
  return do_read_stress(element);
}

void Backend::read_reactions(std::span<double> reactions) const {
  require(stage_ != Stage::created, "there are no reactions before the first solution");
  require(reactions.size() == gripped_dofs().size(), "one reaction per gripped dof");
  do_read_reactions(reactions);
}

}  // namespace sunder
