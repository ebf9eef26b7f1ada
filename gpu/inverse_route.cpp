// SPDX-License-Identifier: Apache-2.0
#include "gpu/inverse_route.hpp"

#include <algorithm>
#include <cmath>

#include "fem/assembly.hpp"
#include "fem/event_factor.hpp"
#include "gpu/passes/block_inversion.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

// So many exact columns begin a new base, which replaces the old one so many events later: a frame
// reads all exact columns, and the inverse of the board takes a thread some 50 frames.
constexpr Index kColumnsPerBase = 256;
constexpr int kEventsUntilNext = 24;

}  // namespace

std::size_t InverseRoute::planned_bytes(const KernelFactory& kernels, const Problem& problem,
                                        const InverseOptions& options) {
  const Index n = problem.dof_count();
  const auto rows = round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
  const auto base = DenseInverse::planned(kernels, n, rows, options.panel_bytes);
  std::size_t bytes = base.bytes;
  std::uint32_t capacity = 0;
  const std::size_t grips = problem.gripped_dofs().size();
  auto picked = static_cast<std::size_t>(options.on_device ? DenseInverse::diagonal_block(n) : 0);
  if (options.eager) picked = std::max(picked, grips);
  if (picked > 0) bytes += DenseInverse::planned_pick(picked, picked);
  if (!options.eager) {
    capacity = ExactColumns::planned_capacity(kernels.device().physical(), rows,
                                              static_cast<Index>(grips));
    bytes += ExactColumns::planned_bytes(rows, capacity);
  }
  const std::size_t sums =
      std::size_t{base.chunks + base.panels + capacity / shaders::kChunk} * rows * sizeof(double);
  if (!options.on_device) return bytes + sums;
  // While it is computed: the fp64 matrix beside the stored one, before the rest exists.
  return std::max(bytes + sums,
                  base.bytes + planned_inversion_bytes(kernels, n, rows, options.panel_bytes));
}

InverseRoute::InverseRoute(const KernelFactory& kernels, const Problem& problem, Fields& fields,
                           std::shared_ptr<const HostInverse> intact, const InverseOptions& options)
    : kernels_(kernels),
      problem_(problem),
      fields_(fields),
      host_(std::move(intact)),
      options_(options),
      eager_(options.eager),
      base_(kernels, problem.dof_count(), fields.rows(), options.panel_bytes),
      exact_(kernels, fields.rows()),
      partials_(kernels, fields.rows()),
      add_(kernels, fields),
      commands_(kernels.device()),
      quiet_(kernels.device()),
      checked_(kernels.device()) {
  next_possible_ = host_->is_dense();
  make_base({});
  if (eager_) {
    bind();
    factor_grips();
  } else {
    defer({});
  }
}

/// X of the body with the elements `destroyed`, and the roots of its diagonal.
void InverseRoute::make_base(std::span<const Index> destroyed) {
  ++bases_;
  base_destroyed_.assign(destroyed.begin(), destroyed.end());
  base_stale_ = false;
  std::vector<double> roots;
  if (options_.on_device) {
    invert_on_device(kernels_, fem::assemble_lower(problem_, scale_of(destroyed)), fields_.rows(),
                     options_.panel_bytes, base_);
    roots = base_.diagonal();
    for (double& x : roots) x = std::sqrt(x);
  } else {
    roots = upload_inverse(*host_, base_, problem_.dof_count());
  }
  fields_.set_roots(roots);
}

/// The base on the device, which a new one leaves behind until something needs it.
void InverseRoute::ensure_base() {
  if (!base_stale_) return;
  static_cast<void>(upload_inverse(*host_, base_, problem_.dof_count()));
  base_stale_ = false;
}

std::vector<double> InverseRoute::scale_of(std::span<const Index> destroyed) const {
  std::vector<double> scale(problem_.mesh().tets.size(), 1.0);
  for (Index e : destroyed) scale[e] = problem_.scene().fracture.alpha;
  return scale;
}

void InverseRoute::bind() {
  // The loaded columns never need more chunks than all columns do, one per panel aside.
  partials_.reserve(base_.chunks() + base_.loaded_chunks({}) + exact_.chunk_capacity());
  base_.bind(partials_, fields_.residual());
  exact_.bind(partials_, fields_.residual());
  exact_.bind_solve(fields_.positions(), fields_.nodal(Field::displacement));
  sum_displacement_ = partials_.bind_sum(fields_.positions(), fields_.nodal(Field::displacement));
  sum_correction_ = partials_.bind_sum(fields_.positions(), fields_.nodal(Field::correction));
  quiet_.columns = checked_.columns = kNone;
}

void InverseRoute::extend_exact() {
  const bool moved = exact_.extend(correction_->columns(), correction_->dofs());
  if (moved || !sum_displacement_) bind();
}

void InverseRoute::record_solution(Field field, std::uint32_t chunks, bool add) {
  commands_.barrier();
  partials_.record_sum(
      commands_, field == Field::displacement ? *sum_displacement_ : *sum_correction_, chunks, add);
  commands_.barrier();
}

void InverseRoute::record_state(bool balance) {
  fields_.record_state(commands_, balance);
  if (!balance || eager_) return;
  commands_.pass("residual");
  exact_.record_project(commands_);
}

int InverseRoute::solve(const Load& load, bool balance) {
  last_ = &commands_;
  if (eager_) {
    solve_eager(load, balance);
  } else {
    solve_deferred(load, balance);
  }
  return 0;
}

std::optional<EnergyBound> InverseRoute::energy_bound() const {
  if (eager_) return std::nullopt;
  // A^-1 = X + X_E M X_E^T, and r^T X r <= (sum of |r_j| sqrt(X_jj))^2 in the norm of X.
  const double of_base = fields_.state().energy_root;
  const double of_damage = correction_->energy(exact_.projection());
  const double of_touched = correction_->base_energy(exact_.values());
  return EnergyBound{std::sqrt(of_base * of_base + of_damage), of_base,
                     std::sqrt(of_touched) + std::sqrt(of_damage)};
}

void InverseRoute::solve_deferred(const Load& load, bool balance) {
  Loaded loaded{load.force_dofs, load.forces};
  const Index added = correction_->new_dofs(loaded.dofs);
  if (added > 0 && loaded.dofs.size() <= kExactLoads &&
      correction_->count() + added <= exact_.most()) {
    correction_->extend(loaded.dofs);
    extend_exact();
  }
  Eigen::VectorXd c = correction_->coefficients(correction_->project(loaded), load.displacements);
  c += correction_->take_exact(loaded);
  exact_.set_coefficients(c);
  if (loaded.dofs.empty() && exact_.whole_in_one()) {
    solve_on_exact(balance);
    return;
  }
  if (!loaded.dofs.empty()) ensure_base();
  base_.set_loaded(loaded);
  commands_.begin();
  fields_.record_keep(commands_);
  commands_.pass("solve");
  std::uint32_t chunks = base_.record_loaded(commands_, 0);
  if (chunks > 0) commands_.barrier();
  chunks += exact_.record_apply(commands_, chunks);
  record_solution(Field::displacement, chunks, false);
  fields_.record_hold(commands_, Field::displacement);
  record_state(balance);
  commands_.end();
  commands_.submit();
}

void InverseRoute::solve_on_exact(bool balance) {
  Recorded& frame = balance ? checked_ : quiet_;
  const bool keep = fields_.keeps_next(), timed = kernels_.device().timing();
  if (frame.columns != exact_.count() || frame.keep != keep || frame.timed != timed) {
    frame.columns = exact_.count();
    frame.keep = keep;
    frame.timed = timed;
    vulkan::Commands& commands = frame.commands;
    commands.begin();
    fields_.record_keep(commands);
    commands.pass("solve");
    exact_.record_solve(commands);
    commands.barrier();
    fields_.record_hold(commands, Field::displacement);
    fields_.record_state(commands, balance);
    if (balance) {
      commands.pass("residual");
      exact_.record_project(commands);
    }
    commands.end();
  }
  fields_.kept();
  frame.commands.submit();
  last_ = &frame.commands;
}

void InverseRoute::solve_eager(const Load& load, bool balance) {
  Loaded loaded{load.force_dofs, load.forces};
  base_.set_loaded(loaded);
  commands_.begin();
  fields_.record_keep(commands_);
  commands_.pass("solve");
  record_solution(Field::displacement, base_.record_loaded(commands_, 0), false);
  if (!problem_.gripped_dofs().empty()) {
    commands_.end();
    commands_.submit();
    base_.set_loaded(grip_forces(Field::displacement, load.displacements));
    commands_.begin();
    commands_.pass("solve");
    record_solution(Field::displacement, base_.record_loaded(commands_, 0), true);
  }
  fields_.record_hold(commands_, Field::displacement);
  record_state(balance);
  commands_.end();
  commands_.submit();
}

int InverseRoute::correct() {
  // Where a processor emulates the device its host applies the factor for a twentieth of what the
  // dense product takes.
  if (!eager_ && kernels_.emulated()) {
    correct_on_host();
    return 0;
  }
  ensure_base();
  if (!eager_) {
    exact_.set_coefficients(correction_->coefficients(exact_.projection(), {}));
  }
  commands_.begin();
  commands_.pass("estimate");
  std::uint32_t chunks = base_.record_dense(commands_, 0);
  if (!eager_) {
    commands_.barrier();
    chunks += exact_.record_apply(commands_, chunks);
  }
  record_solution(Field::correction, chunks, false);
  if (eager_ && !problem_.gripped_dofs().empty()) {
    commands_.end();
    commands_.submit();
    base_.set_loaded(grip_forces(Field::correction, {}));
    commands_.begin();
    commands_.pass("estimate");
    record_solution(Field::correction, base_.record_loaded(commands_, 0), true);
  }
  fields_.record_hold(commands_, Field::correction);
  fields_.record_correction(commands_);
  commands_.end();
  commands_.submit();
  return 0;
}

void InverseRoute::correct_on_host() {
  std::vector<double> r(static_cast<std::size_t>(problem_.dof_count()));
  fields_.residual().read(std::span<double>(r));
  const Eigen::Map<const Eigen::VectorXd> residual(r.data(), problem_.dof_count());
  Eigen::VectorXd du = host_->factor().solve(residual);
  if (const Index count = correction_->count(); count > 0) {
    du +=
        correction_->columns().leftCols(count) * correction_->coefficients(exact_.projection(), {});
  }
  fields_.write_unknowns(Field::correction, du);
  commands_.begin();
  commands_.pass("estimate");
  fields_.record_hold(commands_, Field::correction);
  fields_.record_correction(commands_);
  commands_.end();
  commands_.submit();
}

void InverseRoute::add_correction() {
  commands_.begin();
  commands_.pass("refine");
  add_.record(commands_);
  commands_.barrier();
  record_state(true);
  commands_.end();
  commands_.submit();
}

/// Forces that close the gap between a field at the gripped dofs and what is prescribed there.
Loaded InverseRoute::grip_forces(Field field, std::span<const double> displacement) const {
  const auto gripped = problem_.gripped_dofs();
  Eigen::VectorXd gap = -fields_.read_unknowns(field, gripped);
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    gap[static_cast<Index>(i)] += displacement[i];
  }
  const Eigen::VectorXd forces = grips_.solve(gap);
  return {{gripped.begin(), gripped.end()}, {forces.data(), forces.data() + forces.size()}};
}

void InverseRoute::factor_grips() {
  const auto gripped = problem_.gripped_dofs();
  if (gripped.empty()) return;
  grips_.compute(base_.pick(gripped, gripped));
  if (grips_.info() != Eigen::Success) {
    throw NumericalError("the compliance of the gripped nodes is singular in this precision");
  }
}

void InverseRoute::destroy(std::span<const Index> elements, std::span<const Index> destroyed) {
  if (eager_) {
    if (!update_eager(elements)) {
      defer(destroyed);
      return;
    }
    factor_grips();
    return;
  }
  rebased_ = false;
  if (next_.valid() && --events_until_next_ == 0 && take_next_base(destroyed)) return;
  if (correction_->count() + correction_->new_dofs_of(elements) > exact_.most() ||
      !correction_->destroy(elements)) {
    rebase(destroyed);
    return;
  }
  extend_exact();
  const auto grips = static_cast<Index>(problem_.gripped_dofs().size());
  if (!next_.valid() && next_possible_ && correction_->count() > grips + kColumnsPerBase) {
    start_next_base(destroyed);
  }
}

void InverseRoute::start_next_base(std::span<const Index> destroyed) {
  next_destroyed_.assign(destroyed.begin(), destroyed.end());
  events_until_next_ = kEventsUntilNext;
  next_ = std::async(std::launch::async, [&problem = problem_, scale = scale_of(destroyed)] {
    return std::make_shared<const HostInverse>(problem, scale, true);
  });
}

/// The base to come with what was destroyed since it was begun. False: it is none in double
/// precision, and nothing has changed.
bool InverseRoute::take_next_base(std::span<const Index> destroyed) {
  std::shared_ptr<const HostInverse> host;
  try {
    host = next_.get();
  } catch (const NumericalError&) {
    next_possible_ = false;
    return false;
  }
  auto correction = std::make_unique<Correction>(
      problem_, [host](std::span<const Index> dofs) { return host->columns(dofs); });
  if (!correction->destroy(destroyed.subspan(next_destroyed_.size()))) return false;
  host_ = std::move(host);
  correction_ = std::move(correction);
  base_destroyed_ = next_destroyed_;
  base_stale_ = true;
  ++bases_;
  fields_.set_roots(host_->roots());
  make_exact();
  return true;
}

/// X += Z Z^T with Z = X W L^-T, L L^T = I - W^T X W, all as it stands on the device. False: the
/// precision does not carry it, and nothing has changed.
bool InverseRoute::update_eager(std::span<const Index> elements) {
  const fem::EventFactor event = fem::event_factor(problem_, elements);
  if (event.dofs.empty()) return true;
  const Eigen::MatrixXd w = compressed(event.w);
  Eigen::MatrixXd c = -w.transpose() * base_.pick(event.dofs, event.dofs) * w;
  c.diagonal().array() += 1;
  const Eigen::LLT<Eigen::MatrixXd> llt(c);
  if (llt.info() != Eigen::Success || !llt.matrixLLT().allFinite()) return false;
  base_.update(event.dofs, llt.matrixL().solve(w.transpose()).transpose());
  return true;
}

bool InverseRoute::restart(std::span<const Index> destroyed) {
  if (rebased_ || destroyed.empty()) return false;
  rebase(destroyed);
  return true;
}

/// The recipe from here on: a pristine base and all damage so far as one correction.
void InverseRoute::defer(std::span<const Index> destroyed) {
  const bool overwritten = eager_;
  eager_ = false;
  correction_ = std::make_unique<Correction>(
      problem_, [host = host_](std::span<const Index> dofs) { return host->columns(dofs); });
  if (!destroyed.empty() && !correction_->destroy(destroyed)) {
    rebase(destroyed);
    return;
  }
  if (overwritten) make_base({});
  make_exact();
}

/// The correction's columns on the device, from the first one on.
void InverseRoute::make_exact() {
  exact_.clear();
  exact_.reserve();
  sum_displacement_.reset();
  extend_exact();
}

/// A new base: the inverse of the body as damaged now, from a factor of its own.
void InverseRoute::rebase(std::span<const Index> destroyed) {
  next_ = {};
  host_ = std::make_shared<HostInverse>(problem_, scale_of(destroyed), !options_.on_device);
  make_base(destroyed);
  correction_ = std::make_unique<Correction>(
      problem_, [host = host_](std::span<const Index> dofs) { return host->columns(dofs); });
  make_exact();
  eager_ = false;
  rebased_ = true;
}

std::vector<BufferPlan> InverseRoute::buffers() const {
  std::vector<BufferPlan> plan = {
      {kernels_.fp64() ? "inverse (device, fp64)" : "inverse (device, fp32)", base_.bytes()},
      {"partial sums (device)", partials_.buffer().bytes()},
      {"intact factor and inverse (host)", host_->bytes()}};
  if (correction_) {
    plan.push_back({"exact columns (device)", exact_.bytes()});
    plan.push_back({"exact columns and small matrix (host)", correction_->bytes()});
  }
  return plan;
}

std::vector<vulkan::PassTime> InverseRoute::pass_times() const { return last_->pass_times(); }

}  // namespace sunder::gpu
