// SPDX-License-Identifier: Apache-2.0
#include "gpu/inverse_route.hpp"

#include <algorithm>
#include <numeric>

#include "body/assembly.hpp"
#include "body/event_factor.hpp"
#include "gpu/passes/block_inversion.hpp"
#include "gpu/passes/inverse_refinement.hpp"
#include "solver/update_vectors.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
std::size_t InverseRoute::planned_bytes(const KernelFactory& kernels, const Problem& problem,
                                        const InverseOptions& options) {
  const Index n = problem.dof_count();
  const auto rows = round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
  const KernelFactory stored = options.fp64 ? kernels.in_fp64() : kernels;
  const auto base = DenseInverse::planned(stored, n, rows, options.panel_bytes);
  std::size_t bytes = base.bytes;
  std::uint32_t capacity = 0;
  const std::size_t grips = problem.gripped_dofs().size();
  if (options.eager && grips > 0) bytes += DenseInverse::planned_pick(grips, grips);
  if (!options.eager) {
    capacity = ExactColumns::planned_capacity(kernels.device().physical(), rows,
                                              static_cast<Index>(grips));
    bytes += ExactColumns::planned_bytes(rows, capacity);
  }
  const std::size_t sums =
      std::size_t{base.chunks + base.panels + capacity / shaders::kChunk} * rows * sizeof(double);
  if (!options.on_device) return bytes + sums;
  // While it is computed, before the rest exists.
  const bool refines = !options.eager && kernels.fp64() && !problem.pools();
  return std::max({bytes + sums,
                   base.bytes + planned_inversion_bytes(stored, n, rows, options.panel_bytes),
                   base.bytes + (refines ? planned_refinement_bytes(rows) : 0)});
}

InverseRoute::InverseRoute(const KernelFactory& kernels, const fem::DamagedBody& body,
                           Fields& fields, std::shared_ptr<const HostInverse> intact,
                           const InverseOptions& options, bool damage)
    : kernels_(kernels),
      problem_(body.problem()),
      body_(body),
      fields_(fields),
      intact_(std::move(intact)),
      options_(options),
      eager_(options.eager),
      damage_(damage),
      stored_(options.fp64 ? kernels.in_fp64() : kernels),
      base_(stored_, problem_.dof_count(), fields.rows(), options.panel_bytes),
      exact_(std::make_unique<ExactColumns>(kernels, fields.rows())),
      load_place_(static_cast<std::size_t>(problem_.dof_count()), kNone),
      residual_(problem_.dof_count()),
      partials_(kernels, fields.rows()),
      add_(kernels, fields),
      commands_(kernels.device()),
      quiet_(kernels.device()),
      checked_(kernels.device()) {
  all_.resize(load_place_.size());
  std::iota(all_.begin(), all_.end(), 0);
  fill_base(*intact_);
  if (eager_) {
    bind();
    factor_grips();
  } else {
    renews_ = can_renew();
    update_ = host_update(body_, intact_, damage_, kernels_.fp64(), exact_base(*intact_), renews_);
    new_base(false);
    if (renews_) make_next();
    if (damage_) {  // last: what a frame needs has its room
      damage_solution_ =
          DamageSolution::make(kernels_, columns_of_a_base(renewal_of(problem_, *intact_, renews_)),
                               problem_.gripped_dofs().size(), options_.damage, options_.leave_out);
      update_->deferred().solve_by(damage_solution_.get());
    }
  }
}

/// Whether the device computes the next base's inverse from this one: it has that in fp64, nobody
/// else has it, and there is room for another.
bool InverseRoute::can_renew() const {
  constexpr double kOfMemory = .9;  // the rest is for columns to come, and others
  if (!damage_ || !options_.on_device || exact_base(*intact_) == nullptr) return false;
  const std::size_t bytes = InverseUpdate::planned_bytes(
      stored_, problem_.dof_count(), fields_.rows(), options_.panel_bytes, next_columns());
  const vulkan::Device& device = kernels_.device();
  return static_cast<double>(device.held_bytes() + bytes) <=
         kOfMemory * static_cast<double>(device.physical().memory);
}

/// Columns of the damage by which bases are expected to differ.
std::uint32_t InverseRoute::next_columns() const {
  const solver::Renewal renewal = renewal_of(problem_, *intact_, true);
  const std::size_t between = static_cast<std::size_t>(columns_between(renewal));
  return static_cast<std::uint32_t>(std::max(renewal.columns, between));
}

/// At the start, so that no frame allocates it.
void InverseRoute::make_next() {
  next_ = std::make_unique<InverseUpdate>(stored_, problem_.dof_count(), fields_.rows(),
                                          options_.panel_bytes, next_columns());
  next_exact_ = std::make_unique<ExactColumns>(kernels_, fields_.rows());
  next_exact_->reserve();
}

/// X of the body as it was after base_events_.
void InverseRoute::fill_base(const HostInverse& host) {
  if (options_.on_device) {
    const fem::DamagedBody body = body_.as_of(base_events_);
    invert_on_device(stored_, body.stiffness(), fields_.rows(), options_.panel_bytes, base_);
    if (wants_refinement(host, body)) refine_inverse(stored_, body, fields_.rows(), base_);
  } else {
    upload_inverse(host, base_);
  }
  base_stale_ = false;  // not where that has failed
}

/// Whether columns of the base would have to be refined with each event (gpu/host_base.hpp), and
/// whoever reads them does not do so. Of a later base it does: a frame would wait for all of X. Of
/// a body with pooled volume too: the host has no quick products K X.
bool InverseRoute::wants_refinement(const HostInverse& host, const fem::DamagedBody& body) const {
  if (eager_ || !damage_ || !kernels_.fp64() || host.is_dense() || !base_.fp64()) return false;
  if (problem_.pools() || (update_ && base_of(*update_).refines())) return false;
  return HostBase({std::shared_ptr<void>(), &host}, &body, &base_).refines();
}

/// The base on the device, which a new one leaves behind until a load needs it.
void InverseRoute::ensure_base() {
  if (!base_stale_) return;
  fill_base(base_of(*update_).inverse());
  read_columns();
}

/// Where the device has the update's base in fp64 and the host keeps no dense inverse, new columns
/// are read there; null: not.
const DenseInverse* InverseRoute::exact_base(const HostInverse& host) const {
  return !base_stale_ && base_.fp64() && !host.is_dense() ? &base_ : nullptr;
}

void InverseRoute::read_columns() {
  HostBase& host = base_of(*update_);
  const DenseInverse* there = exact_base(host.inverse());
  columns_there_ = there != nullptr;
  host.read_from(there);
  update_->hold(renews_ && base_stale_);  // the next base would have columns by its factor
}

void InverseRoute::bind() {
  // The loaded columns never need more chunks than all columns do, one per panel aside.
  partials_.reserve(base_.chunks() + base_.loaded_chunks({}) + exact_->chunk_capacity());
  base_.bind(partials_, fields_.residual());
  exact_->bind(partials_);
  exact_->bind_solve(fields_.positions(), fields_.nodal(Field::displacement));
  sum_displacement_ = partials_.bind_sum(fields_.positions(), fields_.nodal(Field::displacement));
  sum_correction_ = partials_.bind_sum(fields_.positions(), fields_.nodal(Field::correction));
  quiet_.columns = checked_.columns = kNone;
}

/// The columns of the update's present base, in place of those of the one before; `with_columns`:
/// they are there, and nothing else is.
void InverseRoute::new_base(bool with_columns) {
  bases_ = update_->bases();
  if (damage_solution_) update_->deferred().solve_by(damage_solution_.get());
  read_columns();
  if (!with_columns) exact_->clear();
  exact_->reserve();
  place_.resize(static_cast<std::size_t>(exact_->count()));
  std::iota(place_.begin(), place_.end(), 0);
  std::fill(load_place_.begin(), load_place_.end(), kNone);
  sum_displacement_.reset();
  extend_exact();
}

/// Brings the columns that the update has gained to the device.
void InverseRoute::extend_exact() {
  const HostBase& base = base_of(*update_);
  const Index before = static_cast<Index>(place_.size());
  for (Index c = before; c < base.count(); ++c) place_.push_back(exact_->count() + c - before);
  const bool moved = exact_->append(base.columns().middleCols(before, base.count() - before));
  if (moved || !sum_displacement_) bind();
}

/// Gives a load of few unknowns columns of its own, so that its solution is exact.
void InverseRoute::hold_loads(const Load& load) {
  if (load.force_dofs.size() > kExactLoads) return;
  std::vector<Index> added;
  for (Index d : load.force_dofs) {
    if (load_place_[d] == kNone) added.push_back(d);
  }
  if (added.empty() || exact_->count() + static_cast<Index>(added.size()) > exact_->most()) return;
  for (std::size_t i = 0; i < added.size(); ++i) {
    load_place_[added[i]] = exact_->count() + static_cast<Index>(i);
  }
  if (exact_->append(base_of(*update_).unit_columns(added))) bind();
}

void InverseRoute::record_solution(Field field, std::uint32_t chunks, bool add) {
  partials_.record_sum(
      commands_, field == Field::displacement ? *sum_displacement_ : *sum_correction_, chunks, add);
}

int InverseRoute::solve(const Load& load, double energy_tolerance, bool balance) {
  if (eager_) {
    solve_eager(load, balance);
  } else {
    solve_deferred(load, energy_tolerance, balance);
  }
  return 0;
}

/// Of the exact columns; returns what of the load has none.
Loaded InverseRoute::set_coefficients(const Load& load, const Eigen::VectorXd& of_damage) {
  coefficients_.setZero(exact_->count());
  for (std::size_t i = 0; i < place_.size(); ++i) {
    coefficients_[place_[i]] = of_damage[static_cast<Index>(i)];
  }
  Loaded rest;
  for (std::size_t i = 0; i < load.force_dofs.size(); ++i) {
    const Index at = load_place_[load.force_dofs[i]];
    if (at != kNone) {
      coefficients_[at] = load.forces[i];
    } else {
      rest.dofs.push_back(load.force_dofs[i]);
      rest.values.push_back(load.forces[i]);
    }
  }
  exact_->set_coefficients(coefficients_);
  return rest;
}

void InverseRoute::solve_deferred(const Load& load, double energy_tolerance, bool balance) {
  update_->loaded(load);
  hold_loads(load);
  const Loaded loaded = set_coefficients(
      load, update_->deferred().coefficients({load.force_dofs, load.forces}, load.displacements,
                                             energy_tolerance));
  if (loaded.dofs.empty() && exact_->whole_in_one()) {
    solve_on_exact(balance);
    return;
  }
  if (!loaded.dofs.empty()) ensure_base();
  base_.set_loaded(loaded);
  commands_.begin();
  fields_.record_keep(commands_);
  commands_.pass("solve");
  std::uint32_t chunks = base_.record_loaded(commands_, 0);
  chunks += exact_->record_apply(commands_, chunks);
  record_solution(Field::displacement, chunks, false);
  fields_.record_hold(commands_, Field::displacement);
  fields_.record_state(commands_, balance);
  commands_.end();
  commands_.submit();
}

void InverseRoute::solve_on_exact(bool balance) {
  Recorded& frame = balance ? checked_ : quiet_;
  const bool keep = fields_.keeps_next(), timed = kernels_.device().timing();
  const ReadAlong::What along = fields_.reads_along();
  if (frame.columns != exact_->count() || frame.keep != keep || frame.timed != timed ||
      frame.along != along) {
    frame.columns = exact_->count();
    frame.keep = keep;
    frame.timed = timed;
    frame.along = along;
    vulkan::Commands& commands = frame.commands;
    commands.begin();
    fields_.record_keep(commands);
    commands.pass("solve");
    exact_->record_solve(commands);
    fields_.record_hold(commands, Field::displacement);
    fields_.record_state(commands, balance);
    commands.end();
  }
  fields_.submitted_again();
  frame.commands.submit();
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
  fields_.record_state(commands_, balance);
  commands_.end();
  commands_.submit();
}

int InverseRoute::correct(bool add) {
  if (eager_) {
    correct_eager();
    if (add) add_correction();
    return 0;
  }
  fields_.read_residual({residual_.data(), all_.size()});
  correct_by_host(residual_, add);
  return 0;
}

bool InverseRoute::correct_by_host(const Eigen::VectorXd& r, bool add) {
  if (eager_) return false;
  update_->deferred().correct({all_, {r.data(), all_.size()}}, correction_);
  fields_.write_unknowns(Field::correction, correction_);
  commands_.begin();
  commands_.pass("estimate");
  fields_.record_correction(commands_);
  if (add) record_addition();
  commands_.end();
  commands_.submit();
  return true;
}

void InverseRoute::correct_eager() {
  commands_.begin();
  commands_.pass("estimate");
  record_solution(Field::correction, base_.record_dense(commands_, 0), false);
  if (!problem_.gripped_dofs().empty()) {
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
}

void InverseRoute::record_addition() {
  commands_.pass("refine");
  add_.record(commands_);
  fields_.record_state(commands_, true);
}

void InverseRoute::add_correction() {
  commands_.begin();
  record_addition();
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

void InverseRoute::destroy(std::span<const Index> elements) {
  if (eager_) {
    if (!update_eager(elements)) {
      defer();
    } else {
      factor_grips();
    }
    return;
  }
  constexpr std::size_t kUnknowns = 12;  // of an element: so many columns at most
  const auto most = static_cast<Index>(std::min(all_.size(), kUnknowns * elements.size()));
  update_->follow({.leave = elements}, exact_->count() + most > exact_->most());
  follow_update();
}

void InverseRoute::grip(const fem::Event& event) {
  if (eager_) throw UsageError("update eager takes no other grips");
  const auto most = static_cast<Index>(event.grasp.size());
  update_->follow(event, exact_->count() + most > exact_->most());
  quiet_.columns = checked_.columns = kNone;
  follow_update();
}

bool InverseRoute::rebase() {
  if (eager_) {
    if (std::ranges::count(body_.destroyed(), 1) == 0) return false;
    defer();
    return true;
  }
  if (!update_->rebase()) return false;
  follow_update();
  return true;
}

/// What the update has gained since, or its new base.
void InverseRoute::follow_update() {
  if (update_->bases() == bases_) extend_exact();
  if (renews_) renew();
  if (update_->bases() == bases_) return;
  const bool there = take_next();
  base_stale_ = !there;
  base_events_ = update_->base_events();
  new_base(there);
}

/// Begins with the next base's inverse where the update has begun with that, goes on with it, and
/// lets that catch up once it is made.
void InverseRoute::renew() {
  const auto coming = update_->coming_events();
  if (next_->in_work() && coming != next_events_) next_->drop();
  if (update_->made()) {
    catch_up();
  } else if (next_->in_work()) {
    next_->advance();
  } else if (coming == body_.events() && !base_stale_) {
    begin_next();
  }
}

void InverseRoute::begin_next() {
  update_->deferred().copy_damage(between_);
  const int events = renewal_of(problem_, *intact_, true).events;
  next_->begin(base_, *exact_, place_, between_, static_cast<std::size_t>(events));
  next_events_ = body_.events();
  next_tried_ = false;
  next_exact_->clear();
}

/// The next base follows some events more, with columns of its inverse where that is right.
void InverseRoute::catch_up() {
  if (next_->in_work() && !next_tried_) {
    next_->finish();
    if (!static_cast<HostBase&>(update_->made()->base()).try_device(next_->inverse())) {
      next_->drop();
    }
    next_tried_ = true;
  }
  const solver::Deferred* made = update_->made();
  update_->catch_up();
  const bool in_place = !update_->made() && &update_->deferred() == made;
  if (!next_->in_work() || (!update_->made() && !in_place)) return;
  const auto& base = static_cast<const HostBase&>(made->base());
  const Index before = next_exact_->count();
  next_exact_->append(base.columns().middleCols(before, base.count() - before));
}

/// The update has a new base. False: it is not the one whose inverse is there.
bool InverseRoute::take_next() {
  if (!renews_ || !next_->in_work()) return false;
  if (!next_tried_ || next_events_ != update_->base_events()) {
    next_->drop();
    return false;
  }
  next_->hand_over(base_);
  std::swap(exact_, next_exact_);
  return true;
}

/// X += Z Z^T with Z = X W L^-T, L L^T = I - W^T X W, all as it stands on the device. False: the
/// precision does not carry it, and nothing has changed.
bool InverseRoute::update_eager(std::span<const Index> elements) {
  const fem::EventFactor event = solver::compressed(fem::event_factor(problem_, elements));
  if (event.dofs.empty()) return true;
  const Eigen::MatrixXd& w = event.w;
  Eigen::MatrixXd c = -w.transpose() * base_.pick(event.dofs, event.dofs) * w;
  c.diagonal().array() += 1;
  const Eigen::LLT<Eigen::MatrixXd> llt(c);
  if (llt.info() != Eigen::Success || !llt.matrixLLT().allFinite()) return false;
  base_.update(event.dofs, llt.matrixL().solve(w.transpose()).transpose());
  return true;
}

/// The recipe from here on: an intact base and all damage so far as one update.
void InverseRoute::defer() {
  eager_ = false;
  base_stale_ = true;  // events have been worked into it
  base_events_ = 0;
  update_ = host_update(body_, intact_, damage_, kernels_.fp64(), exact_base(*intact_));
  std::vector<Index> destroyed;
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    if (body_.destroyed()[e]) destroyed.push_back(e);
  }
  if (!destroyed.empty()) update_->follow({.leave = destroyed});
  if (update_->bases() > 1) base_events_ = body_.events();
  new_base(false);
}

std::vector<BufferPlan> InverseRoute::buffers() const {
  std::vector<BufferPlan> plan = {
      {base_.fp64() ? "inverse (device, fp64)" : "inverse (device, fp32)", base_.bytes()},
      {"partial sums (device)", partials_.buffer().bytes()}};
  if (!update_) {
    plan.push_back({"factor and inverse of the base (host)", intact_->bytes()});
    return plan;
  }
  plan.push_back({"exact columns (device)", exact_->bytes()});
  if (renews_) {
    plan.push_back({"inverse of the next base (device)", next_->bytes() + next_exact_->bytes()});
  }
  if (damage_solution_) {
    plan.push_back({"small matrices of the damage (device)", damage_solution_->bytes()});
  }
  for (BufferPlan& b : update_->deferred().buffers()) plan.push_back(std::move(b));
  return plan;
}

}  // namespace sunder::gpu
