// SPDX-License-Identifier: Apache-2.0
#include "gpu/cg_route.hpp"

#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// Iterations recorded in one submit; the device skips those that it does not need.
constexpr int kIterations = 64;
constexpr std::size_t kArguments = 9;  // words: sizes of three kinds of dispatches
constexpr int kMaxIterations = 50000;
// Energy norms of the residual: a solution to eleven digits, a correction to three.
constexpr double kSolution = 1e-22;
constexpr double kCorrection = 1e-6;

}  // namespace

CgRoute::CgRoute(const KernelFactory& kernels, const Problem& problem, Fields& fields)
    : kernels_(kernels),
      fields_(fields),
      matrix_(fields.matrix()),
      rigid_(kernels, problem),
      add_(kernels, fields),
      commands_(kernels.device()) {
  const std::size_t nodes = std::size_t{matrix_.groups()} * shaders::kGroup;
  for (Buffer* vector : {&r_, &p_, &q_, &z_}) {
    *vector = Buffer(kernels.device(), nodes * 4 * sizeof(double), Placement::device);
    vector->fill_zero();
  }
  for (Buffer* sums : {&pq_, &rz_}) {
    *sums = Buffer(kernels.device(), matrix_.groups() * sizeof(double), Placement::device);
  }
  state_ = Buffer(kernels.device(), sizeof(shaders::CgState), Placement::host);
  arguments_ = Buffer(kernels.device(), kArguments * sizeof(std::uint32_t), Placement::device);
  create_kernels(fields);
}

std::size_t CgRoute::planned_bytes(const Problem& problem) {
  const std::size_t nodes =
      round_up(static_cast<std::uint32_t>(problem.node_count()), shaders::kGroup);
  return 4 * nodes * 4 * sizeof(double) +
         2 * Buffer::padded(nodes / shaders::kGroup * sizeof(double)) +
         Buffer::padded(sizeof(shaders::CgState)) +
         Buffer::padded(kArguments * sizeof(std::uint32_t)) + RigidSpace::planned_bytes(problem);
}

void CgRoute::create_kernels(const Fields& fields) {
  using enum Reads;
  const auto make = [&](Pass& pass, const char* name, std::initializer_list<Reads> reads,
                        std::initializer_list<const Buffer*> buffers) {
    pass.kernel = kernels_.make_fp64(name, reads, sizeof(shaders::CgPush));
    pass.binding = std::make_unique<vulkan::Binding>(kernels_.device(), *pass.kernel,
                                                     std::vector<const Buffer*>(buffers));
  };
  const Buffer& x = fields.nodal(Field::correction);
  const Buffer& m = matrix_.preconditioner();
  make(begin_, "cg_begin", {plain, words, doubles, plain, plain, plain, plain},
       {&fields.residual(), &fields.dofs(), &m, &x, &r_, &z_, &rz_});
  make(start_, "cg_start", {plain, plain, plain, plain}, {&rz_, &state_, &arguments_, &rigid_.w()});
  make(multiply_, "cg_multiply", {doubles, plain, plain, words, doubles, plain, plain},
       {&matrix_.blocks(), &matrix_.columns(), &matrix_.slices(), &fields.dofs(), &p_, &q_, &pq_});
  make(step_, "cg_step", {plain, plain, doubles, doubles, doubles, plain, plain, plain, plain},
       {&pq_, &state_, &m, &p_, &q_, &x, &r_, &z_, &rz_});
  make(direction_, "cg_direction", {plain, plain, plain, doubles, plain, plain, doubles, words},
       {&rz_, &state_, &arguments_, &z_, &p_, &rigid_.w(), &rigid_.modes(), &fields.dofs()});
  rigid_.bind(r_);
}

shaders::CgPush CgRoute::push(std::uint32_t parity, double reduction) const {
  return {matrix_.groups(), parity, reduction, rigid_.groups(), rigid_.solve_groups()};
}

void CgRoute::record_start(double reduction) {
  commands_.dispatch(*begin_.binding, push(0, reduction), matrix_.groups());
  commands_.barrier();
  rigid_.record(commands_, push(0));
  commands_.dispatch(*start_.binding, push(0, reduction), 1);
  commands_.barrier();
  commands_.dispatch(*direction_.binding, push(shaders::kFirst), matrix_.groups());
  commands_.barrier();
}

void CgRoute::record_iterations() {
  for (int i = 0; i < kIterations; ++i) {
    const shaders::CgPush of_iteration = push(static_cast<std::uint32_t>(i % 2));
    const auto dispatch = [&](const Pass& pass) {
      commands_.dispatch_indirect(*pass.binding, of_iteration, arguments_, 0);
      commands_.barrier();
    };
    dispatch(multiply_);
    dispatch(step_);
    rigid_.record_indirect(commands_, of_iteration, arguments_);
    dispatch(direction_);
  }
}

int CgRoute::run(double reduction) {
  static_assert(kIterations % 2 == 0);  // parity goes on where the last submit ended
  rigid_.update();
  for (int submits = 0;; ++submits) {
    commands_.begin();
    commands_.pass("solve");
    if (submits == 0) record_start(reduction);
    record_iterations();
    commands_.end();
    commands_.submit();
    const shaders::CgState state = *state_.mapped<shaders::CgState>();
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

void CgRoute::refresh_state(bool add) {
  commands_.begin();
  fields_.record_keep(commands_);
  if (add) {
    commands_.pass("refine");
    add_.record(commands_);
    commands_.barrier();
  }
  fields_.record_hold(commands_, Field::displacement);
  fields_.record_state(commands_);
  commands_.end();
  commands_.submit();
}

int CgRoute::solve(const Load&, bool) {
  refresh_state(false);  // the last displacement is the first guess
  const int iterations = run(kSolution);
  refresh_state(true);
  return iterations;
}

int CgRoute::correct() {
  const int iterations = run(kCorrection);
  commands_.begin();
  fields_.record_correction(commands_);
  commands_.end();
  commands_.submit();
  return iterations;
}

void CgRoute::add_correction() { refresh_state(true); }

std::vector<BufferPlan> CgRoute::buffers() const {
  const std::size_t vectors = r_.bytes() + p_.bytes() + q_.bytes() + z_.bytes() + pq_.bytes() +
                              rz_.bytes() + state_.bytes() + arguments_.bytes();
  return {{"conjugate gradient vectors (device)", vectors},
          {"rigid motions of groups of nodes (device)", rigid_.bytes()}};
}

}  // namespace sunder::gpu
