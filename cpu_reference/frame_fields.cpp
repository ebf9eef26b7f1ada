// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/frame_fields.hpp"

#include <algorithm>
#include <utility>

#include "body/assembly.hpp"
#include "sunder/fracture_model.hpp"

namespace sunder::cpu_reference {
namespace {

std::span<const double> view(const Eigen::VectorXd& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

}  // namespace

FrameFields::FrameFields(const DamagedBody& body, const Needs& needs,
                         std::optional<solver::Region> region)
    : body_(body),
      problem_(body.problem()),
      nodal_(problem_.dofs().size(), 0.0),
      next_nodal_(nodal_) {
  if (needs.yield) excluded_.assign(problem_.mesh().tets.size(), 0);
  std::vector<Index> elements;  // none: all
  if (region) {
    elements = region->elements;
    condensed_.emplace(body_, std::move(*region));
    if (row_of(problem_.scene().fracture.model).breaks) {
      condensed_->make_room(needs.stress);
    }
    if (elements.empty()) return;
  }
  if (needs.stress || (condensed_ && needs.damage)) {  // a region's check reads it too
    kernel_.emplace(body.shared_problem(), std::move(elements), 0);
  }
  if (!needs.stress) return;
  stress_.assign(kernel_->size(), Voigt::Zero());
  next_stress_ = stress_;
  if (needs.yield) kernel_->keep_bounds();
  kernel_->keep_deformation();
}

void FrameFields::keep_forces() {
  if (!kernel_) kernel_.emplace(body_.shared_problem(), std::vector<Index>(), 0);
  kernel_->keep_forces();
  nodal_forces_ = nodal_;
}

/// Displacement at all nodes.
void FrameFields::scatter(const Eigen::VectorXd& u, std::vector<double>& nodal) const {
  const auto n = static_cast<std::size_t>(problem_.dof_count());
  fem::scatter(problem_, view(u).first(n), std::span(nodal).first(problem_.dofs().size()));
  if (!offsets_.empty()) offsets_.move(view(u).subspan(n), nodal);
}

std::optional<double> FrameFields::take(const Eigen::VectorXd& u) {
  if (condensed_) {
    for (Index n : condensed_->region().nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = problem_.dof(n, axis);
        if (d != kNone) next_nodal_[3 * n + axis] = u[d];
      }
    }
  } else {
    scatter(u, next_nodal_);
    const std::span<const double> own =
        view(u).subspan(static_cast<std::size_t>(problem_.dof_count()));
    own_.assign(own.begin(), own.end());
  }
  if (!kernel_) return std::nullopt;
  fresh_ = false;
  return kernel_->run(next_nodal_, next_stress_);
}

void FrameFields::forces(Eigen::VectorXd& f) {
  kernel_->nodal_forces(nodal_forces_);
  const auto n = static_cast<std::size_t>(problem_.dof_count());
  f.resize(problem_.dof_count() + offsets_.count());
  const std::span<double> all(f.data(), static_cast<std::size_t>(f.size()));
  fem::gather(problem_, std::span<const double>(nodal_forces_).first(problem_.dofs().size()),
              all.first(n));
  if (!offsets_.empty()) offsets_.gather(nodal_forces_, own_, all.subspan(n));
}

double FrameFields::largest_stress(const Eigen::VectorXd& u) {
  scatter(u, nodal_forces_);
  return kernel_->largest(nodal_forces_);
}

void FrameFields::publish(const InverseRoute& by) {
  nodal_.swap(next_nodal_);
  fresh_ = true;
  if (condensed_) condensed_->take(by);
}

void FrameFields::publish_everywhere(const Eigen::VectorXd& u) {
  nodal_.swap(next_nodal_);
  fresh_ = true;
  fem::scatter(problem_, view(u), nodal_);
  condensed_->take(nodal_);
}

StressSummary FrameFields::publish_stress() {
  if (fresh_) std::swap(stress_, next_stress_);
  fresh_ = false;
  if (condensed_) condensed_->publish_stress();
  if (!kernel_ || excluded_.empty()) return {};
  return kernel_->summarize(excluded_, stress_);
}

Deformation FrameFields::deformation() const {
  return kernel_ ? kernel_->deformation(nodal_) : Deformation{};
}

void FrameFields::cut_off(std::span<const Index> elements) {
  if (kernel_) kernel_->cut_off(elements);
}

void FrameFields::exclude_candidates(std::span<const Index> elements) {
  for (Index e : elements) excluded_[e] = 1;
}

void FrameFields::destroy(std::span<const Index> elements) {
  if (!kernel_) return;
  kernel_->destroy(elements);
  kernel_->take_pools(body_.forms());
}

FrameFields::State FrameFields::state() const {
  State state{nodal_, {}, excluded_, {}};
  if (condensed_) state.condensed = condensed_->state();
  if (kernel_) state.cut_off = kernel_->taken_out();
  return state;
}

void FrameFields::restore(const State& state, std::span<const Index> revived) {
  nodal_ = state.nodal;
  next_nodal_.resize(nodal_.size());
  if (has_forces()) nodal_forces_.resize(nodal_.size());
  offsets_.follow(body_.forms());
  if (condensed_) condensed_->restore(*state.condensed);
  excluded_ = state.excluded;
  fresh_ = false;
  if (!kernel_) return;
  kernel_->revive(revived, body_.forms());
  kernel_->take_out_only(state.cut_off);
  kernel_->run(nodal_, next_stress_);
  std::swap(stress_, next_stress_);
}

void FrameFields::change(const fem::Change& change) {
  offsets_.follow(body_.forms());
  const std::size_t all = problem_.dofs().size() + 3 * offsets_.nodes().size();
  // Where they were until now: at their parents, or at the node they have parted from.
  const auto moves = [&](std::vector<double>& nodal) {
    if (nodal.size() >= all) return;
    const std::size_t before = nodal.size();
    nodal.resize(all);
    for (std::size_t i = before; i < all; ++i) {
      const fem::NewNode& node = offsets_.nodes()[(i - problem_.dofs().size()) / 3];
      nodal[i] = nodal[3 * static_cast<std::size_t>(node.parent) + i % 3];
    }
  };
  moves(nodal_);
  moves(next_nodal_);
  if (has_forces()) nodal_forces_.resize(all);
  if (kernel_) kernel_->change(change.come, body_.forms());
}

void FrameFields::read_displacement(std::span<double> displacement) const {
  if (condensed_) condensed_->complete(nodal_);
  std::copy_n(nodal_.begin(), displacement.size(), displacement.begin());
}

void FrameFields::read_displacement(std::span<const Index> nodes,
                                    std::span<Vec3> displacement) const {
  if (condensed_ && !std::ranges::all_of(
                        nodes, [this](Index n) { return condensed_->region().inside[n] != 0; })) {
    condensed_->complete(nodal_);
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    displacement[i] = Vec3(&nodal_[3 * static_cast<std::size_t>(nodes[i])]);
  }
}

void FrameFields::read_stress(std::span<Voigt> stress) const {
  if (!condensed_) {
    std::copy(stress_.begin(), stress_.end(), stress.begin());
    return;
  }
  const auto whole = condensed_->stress();
  std::copy(whole.begin(), whole.end(), stress.begin());
  const auto& elements = condensed_->region().elements;
  for (std::size_t i = 0; i < elements.size(); ++i) stress[elements[i]] = stress_[i];
}

Voigt FrameFields::read_stress(Index element) const {
  if (!condensed_) return stress_[element];
  const Index at = place(element);
  return at != kNone ? stress_[at] : condensed_->stress()[element];
}

const solver::Region* FrameFields::region() const {
  return condensed_ ? &condensed_->region() : nullptr;
}

std::size_t FrameFields::threads() const {
  return kernel_ ? static_cast<std::size_t>(kernel_->threads()) : 1;
}

std::vector<BufferPlan> FrameFields::buffers() const {
  std::vector<BufferPlan> plan;
  if (!stress_.empty()) {
    plan.push_back({"element stress", stress_.size() * sizeof(Voigt)});
    plan.push_back({"element stress of the next frame", next_stress_.size() * sizeof(Voigt)});
  }
  if (kernel_) plan.push_back({"shapes and elasticity of elements", kernel_->bytes()});
  if (condensed_ && condensed_->bytes() > 0) {
    plan.push_back({"fields outside the condensed region", condensed_->bytes()});
  }
  return plan;
}

}  // namespace sunder::cpu_reference
