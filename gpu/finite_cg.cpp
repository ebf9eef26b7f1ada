// SPDX-License-Identifier: Apache-2.0
#include "gpu/finite_cg.hpp"

#include <algorithm>
#include <array>

#include "gpu/passes/cg_sizes.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// Of |residual| in the preconditioner's norm. At .02, .1 and .3 a step of the 1944-element board at
// dt 1/1000 takes 4 to 5, 5 to 7 and 6 to 10 Newton steps, and 128, 106 and 100 ms.
constexpr double kForcing = 0.1;
// Iterations recorded in a submit: twice those of the last one. The device skips the others, which
// costs a launch each.
constexpr int kFewestRecorded = 16, kMostRecorded = 512;
constexpr std::size_t kByNode = size_of_dispatch(shaders::kCgByNode),
                      kByElement = size_of_dispatch(shaders::kCgByElement),
                      kByOne = size_of_dispatch(shaders::kCgByOne);

std::uint32_t groups_of(std::size_t count) {
  return std::max(1U,
                  round_up(static_cast<std::uint32_t>(count), shaders::kGroup) / shaders::kGroup);
}

}  // namespace

FiniteCg::FiniteCg(const KernelFactory& kernels, const Problem& problem,
                   std::span<const std::uint8_t> destroyed, const FiniteCgBody& body)
    : kernels_(kernels),
      problem_(problem),
      elements_(static_cast<std::uint32_t>(problem.tet_count())),
      nodes_(static_cast<std::uint32_t>(problem.node_count())),
      node_groups_(groups_of(nodes_)),
      element_groups_(groups_of(elements_)),
      partials_(round_up(node_groups_ * kernels.parts(), 4) / 4),
      recorded_(4 * kFewestRecorded),
      out_(problem.mesh().tets.size(), 0),
      rigid_(kernels, problem, out_, 0, true) {
  std::ranges::copy(destroyed, out_.begin());
  vulkan::Device& device = kernels.device();
  device.physical().require(std::max(element_groups_, node_groups_),
                            device.physical().limits.groups, "route cg");
  const auto make = [&](std::size_t bytes) {
    Buffer buffer(device, std::max<std::size_t>(bytes, 64), Placement::device);
    buffer.fill_zero();
    return buffer;
  };
  const std::size_t padded = std::size_t{node_groups_} * shaders::kGroup;
  tangents_ = make(std::size_t{4} * shaders::kFiniteTangent * elements_ * kernels.real_bytes());
  inverses_ = make(padded * 6 * sizeof(double));
  dofs_ = make(padded * 4 * sizeof(std::uint32_t));
  for (Buffer* vector : {&x_, &r_, &p_, &q_, &z_}) *vector = make(padded * 4 * sizeof(double));
  for (Buffer* sums : {&pq_, &rz_}) *sums = make(partials_ * 4 * sizeof(double));
  state_ = Buffer(device, sizeof(shaders::CgState), Placement::device);
  read_ = Buffer(device, sizeof(shaders::CgState), Placement::host);
  arguments_ = make(kCgSizeWords * sizeof(std::uint32_t));
  create_passes(body);
}

std::size_t FiniteCg::planned_bytes(const KernelFactory& kernels, const Problem& problem) {
  return std::size_t{4} * shaders::kFiniteTangent * kernels.real_bytes() *
             problem.mesh().tets.size() +
         (6 + 5 * 4 + 4) * sizeof(double) * problem.mesh().nodes.size() +
         RigidSpace::planned_bytes(problem, true);
}

void FiniteCg::make(Pass& pass, std::string_view name, bool real, std::uint32_t group,
                    Buffers buffers) {
  const KernelFactory factory = real ? kernels_ : kernels_.in_fp64();
  pass.kernel = factory.make(name, group);
  pass.binding = std::make_unique<vulkan::Binding>(kernels_.device(), *pass.kernel,
                                                   std::vector<const Buffer*>(buffers));
}

void FiniteCg::create_passes(const FiniteCgBody& body) {
  constexpr std::uint32_t all = shaders::kGroup;
  const std::uint32_t one = kernels_.closing_group();
  for (std::size_t i : {0, 1}) {
    make(tangent_[i], "finite_tangent", true, all,
         {body.u[i], &body.nodes, &body.shape, &body.facts, &body.from, &tangents_, &body.fibres});
    make(begin_[i], "cg_begin", false, all, {body.r[i], &dofs_, &x_, &r_, &p_, &rz_});
  }
  make(blocks_, "finite_blocks", true, all,
       {&tangents_, &body.shape, &body.first, &body.around, &dofs_, &body.target, &inverses_});
  make(apply_, "finite_apply", true, all,
       {&tangents_, &body.shape, &body.nodes, &p_, &body.corners});
  make(multiply_, "finite_multiply", false, all,
       {&body.corners, &body.first, &body.around, &dofs_, &body.target, &p_, &q_, &pq_});
  make(length_, "cg_length", false, one, {&pq_, &rz_, &state_});
  make(step_, "cg_step", false, all,
       {&state_, &inverses_, &p_, &q_, &x_, &r_, &x_, &r_, &z_, &rz_});
  make(check_, "cg_check", false, one, {&rz_, &rigid_.terms(), &state_, &arguments_});
  make(direction_, "cg_direction", false, all,
       {&state_, &z_, &rigid_.w(), &rigid_.modes(), &p_, &p_});
  rigid_.bind(r_);
  make(found_, "finite_found", false, all, {&state_, &dofs_, &x_, &p_, &body.du});
}

void FiniteCg::attach(const solver::RestingBody& body) {
  std::vector<std::uint32_t> dofs(std::size_t{node_groups_} * shaders::kGroup * 4, shaders::kHeld);
  const auto gripped = problem_.gripped_dofs();
  for (Index n = 0; n < problem_.node_count(); ++n) {
    std::uint32_t* of = &dofs[static_cast<std::size_t>(n) * 4];
    of[3] = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem_.dof(n, axis);
      if (d == kNone) continue;
      of[axis] = static_cast<std::uint32_t>(d);
      if (body.frozen()[d] || std::ranges::binary_search(gripped, d)) of[3] |= 1U << axis;
    }
  }
  dofs_.write(std::span<const std::uint32_t>(dofs));
  std::vector<Index> gone;
  bool back = false;
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    if (body.out()[e] && !out_[e]) gone.push_back(e);
    back = back || (out_[e] && !body.out()[e]);
    out_[e] = body.out()[e];
  }
  if (back) rigid_.forget();
  if (!gone.empty()) rigid_.destroy(gone);
}

void FiniteCg::begin(std::span<const double> u, const fem::Inertia& inertia) {
  rigid_.set_inertia(inertia);
  rigid_.update(u);
}

shaders::CgPush FiniteCg::push(bool first) const {
  shaders::CgPush push{};
  push.groups = node_groups_;
  push.partials = partials_;
  rigid_.add_to(push);
  push.elements = element_groups_;
  push.first = first ? 1 : 0;
  push.reduction = kForcing * kForcing;
  return push;
}

void FiniteCg::record_multiply(vulkan::Commands& commands, bool indirect) const {
  const shaders::FiniteCgPush push{elements_, nodes_,
                                   static_cast<std::uint32_t>(problem_.dof_count())};
  if (indirect) {
    commands.dispatch_indirect(*apply_.binding, push, arguments_, kByElement);
    commands.dispatch_indirect(*multiply_.binding, push, arguments_, kByNode);
  } else {
    commands.dispatch(*apply_.binding, push, element_groups_);
    commands.dispatch(*multiply_.binding, push, node_groups_);
  }
}

void FiniteCg::record(vulkan::Commands& commands, const shaders::FinitePush& of_body,
                      std::size_t state) {
  const shaders::FiniteCgPush of_tangent{elements_, nodes_,
                                         static_cast<std::uint32_t>(problem_.dof_count())};
  const auto dispatch = [&](const Pass& pass, const auto& push, std::uint32_t groups) {
    commands.dispatch(*pass.binding, push, groups);
  };
  commands.pass("tangent");
  commands.fill_zero(x_, 0, x_.bytes());
  dispatch(tangent_[state], of_body, element_groups_);
  dispatch(blocks_, of_tangent, node_groups_);
  commands.pass("conjugate gradients");
  const shaders::CgPush start = push(true), on = push(false);
  dispatch(begin_[state], start, node_groups_);
  record_multiply(commands, false);
  dispatch(length_, start, 1);
  commands.dispatch(*step_.binding, node_groups_);
  rigid_.record(commands, start);
  dispatch(check_, start, 1);
  dispatch(direction_, start, node_groups_);
  const auto again = [&](const Pass& pass, std::size_t size) {
    commands.dispatch_indirect(*pass.binding, on, arguments_, size);
  };
  for (int i = 0; i < recorded_; ++i) {
    record_multiply(commands, true);
    again(length_, kByOne);
    commands.dispatch_indirect(*step_.binding, arguments_, kByNode);
    rigid_.record_indirect(commands, on, arguments_);
    again(check_, kByOne);
    again(direction_, kByNode);
  }
  dispatch(found_, of_tangent, node_groups_);
  commands.copy(state_.handle(), state_.offset(), read_.handle(), read_.offset(),
                sizeof(shaders::CgState));
}

int FiniteCg::iterations() const {
  return static_cast<int>(read_.mapped<shaders::CgState>()->iterations);
}

void FiniteCg::learn() { recorded_ = std::clamp(2 * iterations(), kFewestRecorded, kMostRecorded); }

std::vector<BufferPlan> FiniteCg::buffers() const {
  std::size_t vectors = dofs_.bytes() + state_.bytes() + read_.bytes() + arguments_.bytes();
  for (const Buffer* of : {&x_, &r_, &p_, &q_, &z_, &pq_, &rz_}) vectors += of->bytes();
  return {{"tangents of all elements (device)", tangents_.bytes() + inverses_.bytes()},
          {"conjugate gradient vectors (device)", vectors},
          {"rigid motions of groups of nodes (device)", rigid_.bytes()}};
}

}  // namespace sunder::gpu
