// SPDX-License-Identifier: Apache-2.0
#include "gpu/host_corrected_route.hpp"

#include <algorithm>
#include <numeric>

namespace sunder::gpu {

std::size_t HostCorrectedRoute::planned_bytes(const KernelFactory& kernels, const Problem& problem,
                                              std::size_t panel_bytes) {
  const Index n = problem.dof_count();
  const auto rows = round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
  const auto base = DenseInverse::planned(kernels, n, rows, panel_bytes);
  return base.bytes + std::size_t{base.chunks + base.panels} * rows * sizeof(double);
}

HostCorrectedRoute::HostCorrectedRoute(const KernelFactory& kernels, const fem::DamagedBody& body,
                                       Fields& fields, std::shared_ptr<const HostInverse> intact,
                                       std::size_t panel_bytes, bool damage)
    : problem_(body.problem()),
      fields_(fields),
      supernodes_(intact->factor().cholesky().shared_supernodes()),
      update_(host_update(body, intact, damage, false)),
      base_(kernels, problem_.dof_count(), fields.rows(), panel_bytes),
      partials_(kernels, fields.rows(), base_.chunks() + base_.loaded_chunks({})),
      add_(kernels, fields),
      commands_(kernels.device()) {
  all_.resize(static_cast<std::size_t>(problem_.dof_count()));
  std::iota(all_.begin(), all_.end(), 0);
  base_.bind(partials_, fields_.residual());
  sum_displacement_ = partials_.bind_sum(fields_.positions(), fields_.nodal(Field::displacement));
  upload_inverse(*intact, base_);
}

void HostCorrectedRoute::ensure_base() {
  if (base_stale_) upload_inverse(base_of(*update_).inverse(), base_);
  base_stale_ = false;
}

/// Of the present base's inverse.
const Eigen::MatrixXd& HostCorrectedRoute::load_columns(std::span<const Index> dofs) {
  if (!std::ranges::equal(dofs, loaded_)) {
    load_columns_ = base_of(*update_).inverse().columns(dofs);
    loaded_.assign(dofs.begin(), dofs.end());
  }
  return load_columns_;
}

/// Displacement = X B c, and X f where the load has few unknowns.
void HostCorrectedRoute::write_exact(const Load& load, const Eigen::VectorXd& of_damage,
                                     bool loads) {
  const HostBase& base = base_of(*update_);
  exact_.setZero(problem_.dof_count());
  if (base.count() > 0) {
    exact_.noalias() += base.columns().leftCols(base.count()) * of_damage.head(base.count());
  }
  if (loads && !load.forces.empty()) {
    exact_.noalias() += load_columns(load.force_dofs) *
                        Eigen::Map<const Eigen::VectorXd>(
                            load.forces.data(), static_cast<Eigen::Index>(load.forces.size()));
  }
  fields_.write_unknowns(Field::correction, exact_);  // there is none yet
}

int HostCorrectedRoute::solve(const Load& load, double energy_tolerance, bool balance) {
  update_->loaded(load);
  const bool few = load.force_dofs.size() <= kExactLoads;
  const Eigen::VectorXd& c = update_->deferred().coefficients({load.force_dofs, load.forces},
                                                              load.displacements, energy_tolerance);
  write_exact(load, c, few);
  if (!few) ensure_base();
  base_.set_loaded(few ? Loaded{} : Loaded{load.force_dofs, load.forces});
  fields_.read_along(balance ? ReadAlong::What::displacement : ReadAlong::What::nothing);
  commands_.begin();
  fields_.record_keep(commands_);
  commands_.pass("solve");
  const vulkan::Buffer &exact = fields_.nodal(Field::correction),
                       &u = fields_.nodal(Field::displacement);
  commands_.copy(exact.handle(), exact.offset(), u.handle(), u.offset(), u.bytes());
  const std::uint32_t chunks = base_.record_loaded(commands_, 0);
  if (chunks > 0) partials_.record_sum(commands_, *sum_displacement_, chunks, true);
  fields_.record_hold(commands_, Field::displacement);
  fields_.record_state(commands_, balance);
  commands_.end();
  commands_.submit();
  if (balance) fields_.balance_on_host();
  return 0;
}

int HostCorrectedRoute::correct(bool add) {
  const Eigen::VectorXd& r = fields_.host_balance().residual();
  update_->deferred().correct({all_, {r.data(), all_.size()}}, correction_);
  fields_.write_unknowns(Field::correction, correction_);
  commands_.begin();
  commands_.pass("estimate");
  fields_.record_correction(commands_);
  if (add) record_addition();
  commands_.end();
  commands_.submit();
  if (add) fields_.balance_on_host();
  return 0;
}

void HostCorrectedRoute::record_addition() {
  fields_.read_along(ReadAlong::What::displacement);
  commands_.pass("refine");
  add_.record(commands_);
  fields_.record_state(commands_);
}

void HostCorrectedRoute::add_correction() {
  commands_.begin();
  record_addition();
  commands_.end();
  commands_.submit();
  fields_.balance_on_host();
}

void HostCorrectedRoute::destroy(std::span<const Index> elements) {
  update_->follow({.leave = elements});
  follow_update();
}

void HostCorrectedRoute::grip(const fem::Event& event) {
  update_->follow(event);
  follow_update();
}

bool HostCorrectedRoute::rebase() {
  if (!update_->rebase()) return false;
  follow_update();
  return true;
}

void HostCorrectedRoute::follow_update() {
  if (update_->bases() == bases_) return;
  bases_ = update_->bases();
  base_stale_ = true;
  loaded_.clear();
}

std::vector<BufferPlan> HostCorrectedRoute::buffers() const {
  std::vector<BufferPlan> plan = {{"inverse (device, fp32)", base_.bytes()},
                                  {"partial sums (device)", partials_.buffer().bytes()}};
  for (BufferPlan& b : update_->deferred().buffers()) plan.push_back(std::move(b));
  return plan;
}

}  // namespace sunder::gpu
