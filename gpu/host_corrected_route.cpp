// SPDX-License-Identifier: Apache-2.0
#include "gpu/host_corrected_route.hpp"

#include <cmath>

#include "fem/assembly.hpp"

namespace sunder::gpu {

std::size_t HostCorrectedRoute::planned_bytes(const KernelFactory& kernels, const Problem& problem,
                                              std::size_t panel_bytes) {
  const Index n = problem.dof_count();
  const auto rows = round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
  const auto base = DenseInverse::planned(kernels, n, rows, panel_bytes);
  return base.bytes + std::size_t{base.chunks + base.panels} * rows * sizeof(double);
}

HostCorrectedRoute::HostCorrectedRoute(const KernelFactory& kernels, const Problem& problem,
                                       Fields& fields, std::shared_ptr<const HostInverse> intact,
                                       std::size_t panel_bytes)
    : problem_(problem),
      fields_(fields),
      host_(std::move(intact)),
      base_(kernels, problem.dof_count(), fields.rows(), panel_bytes),
      partials_(kernels, fields.rows(), base_.chunks() + base_.loaded_chunks({})),
      add_(kernels, fields),
      commands_(kernels.device()) {
  base_.bind(partials_, fields.residual());
  sum_displacement_ = partials_.bind_sum(fields.positions(), fields.nodal(Field::displacement));
  sum_correction_ = partials_.bind_sum(fields.positions(), fields.nodal(Field::correction));
  make_base();
}

void HostCorrectedRoute::make_base() {
  ++bases_;
  fields_.set_roots(upload_inverse(*host_, base_, problem_.dof_count()));
  correction_ = std::make_unique<Correction>(
      problem_, [host = host_](std::span<const Index> dofs) { return host->columns(dofs); });
}

/// field = X_E c, on the host.
void HostCorrectedRoute::write_corrected(Field field, const Eigen::VectorXd& coefficients) {
  if (correction_->count() == 0) {
    fields_.write_unknowns(field, Eigen::VectorXd::Zero(problem_.dof_count()));
  } else {
    fields_.write_unknowns(field,
                           correction_->columns().leftCols(correction_->count()) * coefficients);
  }
}

void HostCorrectedRoute::record_sum(Field field, std::uint32_t chunks) {
  if (chunks > 0) {
    commands_.barrier();
    partials_.record_sum(commands_,
                         field == Field::displacement ? *sum_displacement_ : *sum_correction_,
                         chunks, true);
  }
  commands_.barrier();
}

int HostCorrectedRoute::solve(const Load& load, bool balance) {
  Loaded loaded{load.force_dofs, load.forces};
  if (loaded.dofs.size() <= kExactLoads) correction_->extend(loaded.dofs);
  Eigen::VectorXd c = correction_->coefficients(correction_->project(loaded), load.displacements);
  c += correction_->take_exact(loaded);
  if (fields_.keeps_next()) {  // before the host writes there
    commands_.begin();
    fields_.record_keep(commands_);
    commands_.end();
    commands_.submit();
  }
  write_corrected(Field::displacement, c);
  base_.set_loaded(loaded);
  commands_.begin();
  commands_.pass("solve");
  record_sum(Field::displacement, base_.record_loaded(commands_, 0));
  fields_.record_hold(commands_, Field::displacement);
  fields_.record_state(commands_, balance);
  commands_.end();
  commands_.submit();
  if (balance) fields_.balance_on_host();
  return 0;
}

std::optional<EnergyBound> HostCorrectedRoute::energy_bound() const {
  const HostBalance& balance = fields_.host_balance();
  const double of_base = balance.energy_root();
  const double of_damage = correction_->energy(correction_->project(balance.residual()));
  return EnergyBound{std::sqrt(of_base * of_base + of_damage), of_base, std::sqrt(of_damage)};
}

int HostCorrectedRoute::correct() {
  const Eigen::VectorXd& r = fields_.host_balance().residual();
  write_corrected(Field::correction, correction_->coefficients(correction_->project(r), {}));
  std::vector<double> padded(fields_.rows(), 0.0);
  std::copy(r.begin(), r.end(), padded.begin());
  fields_.write_residual(padded);
  commands_.begin();
  commands_.pass("estimate");
  record_sum(Field::correction, base_.record_dense(commands_, 0));
  fields_.record_hold(commands_, Field::correction);
  fields_.record_correction(commands_);
  commands_.end();
  commands_.submit();
  return 0;
}

void HostCorrectedRoute::add_correction() {
  commands_.begin();
  commands_.pass("refine");
  add_.record(commands_);
  commands_.barrier();
  fields_.record_state(commands_);
  commands_.end();
  commands_.submit();
  fields_.balance_on_host();
}

void HostCorrectedRoute::destroy(std::span<const Index> elements,
                                 std::span<const Index> destroyed) {
  if (!correction_->destroy(elements)) static_cast<void>(restart(destroyed));
}

/// A new base: the inverse of the body as damaged now.
bool HostCorrectedRoute::restart(std::span<const Index> destroyed) {
  if (bases_ > 1 || destroyed.empty()) return false;
  std::vector<double> scale(problem_.mesh().tets.size(), 1.0);
  for (Index e : destroyed) scale[e] = problem_.scene().fracture.alpha;
  host_ = std::make_shared<HostInverse>(problem_, scale, true);
  make_base();
  return true;
}

std::vector<BufferPlan> HostCorrectedRoute::buffers() const {
  return {{"inverse (device, fp32)", base_.bytes()},
          {"partial sums (device)", partials_.buffer().bytes()},
          {"intact factor and inverse (host)", host_->bytes()},
          {"exact columns and small matrix (host)", correction_->bytes()}};
}

}  // namespace sunder::gpu
