// SPDX-License-Identifier: Apache-2.0
#include "gpu/cg_route.hpp"

#include <algorithm>
#include <cstring>

#include "gpu/passes/cg_sizes.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// Iterations recorded in one submit; the device skips those that it does not need.
constexpr int kIterations = 64;
constexpr int kMaxIterations = 50000;
// Energy norms of the residual, squared: a solution to eleven digits of its own energy, so that a
// good first guess saves iterations; a correction to two, as it is an estimate of the error.
constexpr double kSolution = 1e-22;
constexpr double kCorrection = 1e-4;

std::uint32_t nodes_of(const Problem& problem) {
  return round_up(static_cast<std::uint32_t>(problem.node_count()), shaders::kGroup);
}

std::size_t known_slot(std::size_t nodes) { return nodes * 4 * sizeof(double); }

/// The first solution of a body, which later ones do not displace, and two hands that shift and
/// turn; no more than a scene's instruments can do, nor than a buffer of the device holds.
std::uint32_t most_known(const KernelFactory& kernels, const Problem& problem) {
  constexpr std::size_t kFewest = 2, kMost = 12, kOfAHand = 6;
  const auto& scene = problem.scene();
  const std::size_t wanted =
      scene.live ? kMost : std::clamp(kOfAHand * scene.instruments.size(), kFewest, kMost);
  const std::size_t held =
      kernels.device().physical().limits.buffer_bytes.value / known_slot(nodes_of(problem));
  return static_cast<std::uint32_t>(std::clamp<std::size_t>(held, 1, wanted));
}

}  // namespace

CgRoute::CgRoute(const KernelFactory& kernels, const fem::DamagedBody& body, Fields& fields)
    : kernels_(kernels),
      body_(body),
      fields_(fields),
      matrix_(fields.matrix()),
      rigid_(kernels, body.problem(), body.destroyed(), body.problem().scene().fracture.alpha),
      add_(kernels, fields),
      most_known_(most_known(kernels, body.problem())),
      commands_(kernels.device()),
      iterations_(kernels.device()) {
  const vulkan::PhysicalDevice& device = kernels.device().physical();
  device.require(std::max({matrix_.groups(), matrix_.patches().groups(), rigid_.most_workgroups()}),
                 device.limits.groups, "route cg");
  const std::size_t nodes = std::size_t{matrix_.groups()} * shaders::kGroup;
  for (Buffer* vector : {&r_, &p_, &q_, &z_}) {
    *vector = Buffer(kernels.device(), nodes * 4 * sizeof(double), Placement::device);
    vector->fill_zero();
  }
  for (Buffer* sums : {&pq_, &rz_}) {
    *sums = Buffer(kernels.device(), partials() * 4 * sizeof(double), Placement::device);
    sums->fill_zero();
  }
  known_ = Buffer(kernels.device(), known_slot(nodes) * most_known_, Placement::device);
  known_.fill_zero();
  state_ = Buffer(kernels.device(), sizeof(shaders::CgState), Placement::device);
  found_ = Buffer(kernels.device(), sizeof(shaders::CgState), Placement::host);
  arguments_ = Buffer(kernels.device(), kCgSizeWords * sizeof(std::uint32_t), Placement::device);
  create_kernels(fields);
}

std::uint32_t CgRoute::partials() const {
  return round_up(matrix_.groups() * kernels_.parts(), 4) / 4;
}

std::size_t CgRoute::planned_bytes(const KernelFactory& kernels, const Problem& problem) {
  const std::uint32_t nodes = nodes_of(problem);
  return std::size_t{4} * nodes * 4 * sizeof(double) +
         known_slot(nodes) * most_known(kernels, problem) +
         2 * round_up(nodes / shaders::kGroup * kernels.parts(), 4) * sizeof(double) +
         2 * Buffer::padded(sizeof(shaders::CgState)) +
         Buffer::padded(kCgSizeWords * sizeof(std::uint32_t)) + RigidSpace::planned_bytes(problem);
}

void CgRoute::create_kernels(const Fields& fields) {
  const KernelFactory kernels = kernels_.in_fp64();
  const auto make = [&](Pass& pass, const char* name, std::uint32_t group,
                        const std::vector<const Buffer*>& buffers) {
    pass.kernel = kernels.make(name, group);
    pass.binding = std::make_unique<vulkan::Binding>(kernels.device(), *pass.kernel, buffers);
  };
  constexpr std::uint32_t all = shaders::kGroup;
  const std::uint32_t one = kernels.closing_group();
  const Buffer& x = fields.nodal(Field::correction);
  const Buffer& m = matrix_.preconditioner();
  make(begin_, "cg_begin", all,
       {&fields.residual(), &fields.dofs(), &fields.nodal(Field::displacement), &r_, &p_, &rz_});
  make(known_step_, "cg_known", all, {&known_, &fields.dofs(), &r_, &p_, &rz_});
  const PatchVectors& patches = matrix_.patches();
  std::vector<const Buffer*> of_product{
      &matrix_.blocks(), &matrix_.slices(), &fields.dofs(), &p_, &q_, &pq_};
  if (!patches.empty()) {
    patches.append_to(of_product);
    patch_sums_.kernel = kernels.make("patch_sums", all);
    patch_sums_.binding = patches.bind_sums(kernels, *patch_sums_.kernel, p_);
  }
  make(multiply_, patches.empty() ? "cg_multiply" : "cg_multiply_pooled", all, of_product);
  make(length_, "cg_length", one, {&pq_, &rz_, &state_});
  make(step_, "cg_step", all, {&state_, &m, &p_, &q_, &x, &r_, &x, &r_, &z_, &rz_});
  make(check_, "cg_check", one, {&rz_, &rigid_.terms(), &state_, &arguments_});
  make(direction_, "cg_direction", all, {&state_, &z_, &rigid_.w(), &rigid_.modes(), &p_, &p_});
  rigid_.bind(r_);
}

shaders::CgPush CgRoute::push(bool first) const {
  shaders::CgPush push{};
  push.groups = matrix_.groups();
  push.partials = partials();
  rigid_.add_to(push);
  push.first = first ? 1 : 0;
  push.elements = matrix_.patches().groups_now();
  return push;
}

void CgRoute::record_start(double reduction, bool solution) {
  shaders::CgPush of_start = push(true);
  of_start.reduction = reduction;
  const Buffer& x = fields_.nodal(Field::correction);
  commands_.fill_zero(x, 0, x.bytes());
  const auto dispatch = [&](const Pass& pass, std::uint32_t groups) {
    commands_.dispatch(*pass.binding, of_start, groups);
  };
  dispatch(begin_, matrix_.groups());
  const auto step = [&] {
    if (patch_sums_.binding) dispatch(patch_sums_, matrix_.patches().groups_now());
    dispatch(multiply_, matrix_.groups());
    dispatch(length_, 1);
    dispatch(step_, matrix_.groups());
  };
  if (solution) {
    of_start.guess = 2;
    for (; of_start.known < std::max(known_count_, 1u); ++of_start.known) {
      dispatch(known_step_, matrix_.groups());
      step();
    }
  } else {
    step();
  }
  if (solution && known_count_ > 0) {  // what is left of x is the next one that is known
    add_.record(commands_);
    commands_.fill_zero(x, 0, x.bytes());
  }
  rigid_.record(commands_, of_start);
  dispatch(check_, 1);
  dispatch(direction_, matrix_.groups());
}

void CgRoute::record_iterations() {
  const shaders::CgPush of_iteration = push(false);
  const bool timed = kernels_.device().timing();
  if (recorded_ && timed == recorded_timed_ && rigid_.bound() == recorded_levels_ &&
      std::memcmp(&*recorded_, &of_iteration, sizeof(of_iteration)) == 0) {
    return;
  }
  recorded_.reset();
  iterations_.begin();
  iterations_.pass("solve");
  const auto dispatch = [&](const Pass& pass, std::uint32_t kind) {
    iterations_.dispatch_indirect(*pass.binding, of_iteration, arguments_, size_of_dispatch(kind));
  };
  for (int i = 0; i < kIterations; ++i) {
    if (patch_sums_.binding) dispatch(patch_sums_, shaders::kCgByElement);
    dispatch(multiply_, shaders::kCgByNode);
    dispatch(length_, shaders::kCgByOne);
    dispatch(step_, shaders::kCgByNode);
    rigid_.record_indirect(iterations_, of_iteration, arguments_);
    dispatch(check_, shaders::kCgByOne);
    dispatch(direction_, shaders::kCgByNode);
  }
  record_state(iterations_);
  iterations_.end();
  recorded_ = of_iteration;
  recorded_timed_ = timed;
  recorded_levels_ = rigid_.bound();
}

void CgRoute::record_state(vulkan::Commands& commands) const {
  commands.copy(state_.handle(), state_.offset(), found_.handle(), found_.offset(),
                sizeof(shaders::CgState));
}

void CgRoute::record_begin() {
  const Buffer& u = fields_.nodal(Field::displacement);
  fields_.record_keep(commands_);
  if (known_count_ == 0) {
    commands_.copy(u.handle(), u.offset(), known_.handle(), known_.offset(), slot_bytes());
  }
  commands_.fill_zero(u, 0, u.bytes());
  fields_.record_hold(commands_, Field::displacement);
  fields_.record_state(commands_);
}

void CgRoute::start(double reduction, bool solution) {
  const bool iterates = !solution || !quiet_;
  if (iterates) record_iterations();
  commands_.begin();
  commands_.pass("solve");
  if (solution) record_begin();
  record_start(reduction, solution);
  if (iterates) {
    commands_.end();
    commands_.submit(&iterations_);
  } else {
    record_state(commands_);
    commands_.end();
    commands_.submit();
  }
}

int CgRoute::run(double reduction, bool solution) {
  rigid_.update();
  for (int submits = 0;; ++submits) {
    if (submits == 0) {
      start(reduction, solution);
    } else {
      record_iterations();
      iterations_.submit();
    }
    const shaders::CgState state = *found_.mapped<shaders::CgState>();
    const auto iterations = static_cast<int>(state.iterations);
    if (state.broken) {
      throw NumericalError("conjugate gradients broke down after " + std::to_string(iterations) +
                           " iterations: the stiffness is not positive definite in rounding; use "
                           "route inverse or backend cpu");
    }
    if (!state.running) return iterations;
    if (iterations >= kMaxIterations) {
      throw NumericalError("conjugate gradients did not converge in " + std::to_string(iterations) +
                           " iterations (a part that is cut off is held by destroyed elements "
                           "only); use route inverse or backend cpu");
    }
  }
}

void CgRoute::finish(bool keep_known) {
  commands_.begin();
  if (keep_known && (known_count_ == 0 || most_known_ > 1)) {
    const Buffer& x = fields_.nodal(Field::correction);
    next_known_ = known_count_ == 0 ? 0 : next_known_;
    commands_.copy(x.handle(), x.offset(), known_.handle(),
                   known_.offset() + next_known_ * slot_bytes(), slot_bytes());
    known_count_ = std::min(known_count_ + 1, most_known_);
    if (++next_known_ == most_known_) next_known_ = 1;
  }
  commands_.pass("refine");
  add_.record(commands_);
  fields_.record_hold(commands_, Field::displacement);
  fields_.record_state(commands_);
  commands_.end();
  commands_.submit();
}

int CgRoute::solve(const Load&, double, bool) {
  const int iterations = run(kSolution, true);
  quiet_ = iterations == 0;
  // One that costs no more than to be known is rounding of the others.
  finish(iterations > static_cast<int>(most_known_));
  return iterations;
}

int CgRoute::correct(bool add) {
  const int iterations = run(kCorrection, false);
  commands_.begin();
  fields_.record_correction(commands_);
  commands_.end();
  commands_.submit();
  if (add) add_correction();
  return iterations;
}

void CgRoute::add_correction() { finish(false); }

std::vector<BufferPlan> CgRoute::buffers() const {
  const std::size_t vectors = r_.bytes() + p_.bytes() + q_.bytes() + z_.bytes() + pq_.bytes() +
                              rz_.bytes() + state_.bytes() + found_.bytes() + arguments_.bytes();
  return {{"conjugate gradient vectors (device)", vectors},
          {"solutions that conjugate gradients begin with (device)", known_.bytes()},
          {"rigid motions of groups of nodes (device)", rigid_.bytes()}};
}

}  // namespace sunder::gpu
