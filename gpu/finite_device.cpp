// SPDX-License-Identifier: Apache-2.0
#include "gpu/finite_device.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "body/pools.hpp"
#include "gpu/finite_tables.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

using shaders::FinitePush;
using vulkan::Buffer;
using vulkan::Placement;

/// Into how many shares the sums of an iteration are cut, each for a workgroup: none where one is
/// as quick as another dispatch would begin.
std::uint32_t shares_for(std::uint32_t elements, std::uint32_t unknowns) {
  constexpr std::uint32_t kMostOfOne = 16384, kOfAShare = 4096, kMostShares = 256;
  const std::uint32_t most = std::max(elements / 16, unknowns);
  return most <= kMostOfOne ? 1 : std::min(round_up(most, kOfAShare) / kOfAShare, kMostShares);
}

// Least room for the unknowns that what has left touches.
constexpr std::uint32_t kFirstRank = 64;

std::uint32_t u32(std::size_t value) { return static_cast<std::uint32_t>(value); }

template <class T>
Buffer filled(vulkan::Device& device, const std::vector<T>& values) {
  Buffer buffer(device, std::max<std::size_t>(values.size(), 1) * sizeof(T), Placement::device);
  if (!values.empty()) buffer.write(std::span<const T>(values));
  return buffer;
}

std::span<double> numbers_of(std::span<Voigt> stress) {
  if (stress.empty()) return {};
  return {stress.front().data(), 6 * stress.size()};
}

}  // namespace

std::size_t FiniteDevice::inverse_bytes(const KernelFactory& kernels, const Problem& problem) {
  const std::size_t rows =
      round_up(u32(static_cast<std::size_t>(problem.dof_count())), shaders::kChunk);
  return rows * rows * kernels.real_bytes();
}

Index FiniteDevice::most_inverse(const KernelFactory& kernels) {
  const auto rows = static_cast<std::size_t>(
      std::sqrt(static_cast<double>(largest_buffer(kernels) / kernels.real_bytes())));
  return static_cast<Index>(rows / shaders::kChunk * shaders::kChunk);
}

std::size_t FiniteDevice::route_bytes(const KernelFactory& kernels, Route route,
                                      const Problem& problem) {
  if (route == Route::inverse) return inverse_bytes(kernels, problem);
  return route == Route::cg ? FiniteCg::planned_bytes(kernels, problem) : 0;
}

std::size_t FiniteDevice::largest_buffer(const KernelFactory& kernels) {
  const vulkan::PhysicalDevice& device = kernels.device().physical();
  return std::min<std::size_t>({device.limits.buffer_bytes.value,
                                device.limits.allocation_bytes.value,
                                device.limits.texels.value * 16});
}

FiniteDevice::FiniteDevice(const KernelFactory& kernels, const fem::HyperelasticBody& body,
                           const Options& options, std::shared_ptr<void> keeps)
    : keeps_(std::move(keeps)),
      kernels_(kernels),
      device_(kernels.device()),
      problem_(body.problem),
      options_(options),
      elements_(u32(problem_.mesh().tets.size())),
      nodes_(u32(problem_.mesh().nodes.size())),
      entries_(3 * nodes_),
      unknowns_(u32(static_cast<std::size_t>(problem_.dof_count()))),
      patches_(problem_.pools() ? u32(static_cast<std::size_t>(problem_.pools()->count())) : 0),
      rows_(round_up(std::max(unknowns_, 1U), shaders::kChunk)),
      pairs_(options.route == Route::inverse
                 ? std::min(u32(static_cast<std::size_t>(options.pairs)), shaders::kFinitePairs)
                 : 0),
      shares_(options.shares > 0 ? options.shares : shares_for(elements_, unknowns_)),
      commands_(kernels.device()) {
  const std::size_t route = route_bytes(kernels, options.route, problem_);
  if (route > largest_buffer(kernels)) {
    const bool inverse = options.route == Route::inverse;
    throw DeviceError("the device \"" + device_.physical().name + "\" takes buffers of " +
                      std::to_string(largest_buffer(kernels)) + " bytes, but the " +
                      (inverse ? "inverse of a tangent needs " : "tangents of all elements need ") +
                      std::to_string(route) + "; use precision fp32, " +
                      (inverse && problem_.moves() ? "route cg, " : "") +
                      "a coarser mesh or backend cpu");
  }
  // Besides: states and vectors, some 60 numbers a node, mesh, fibres and forces, 71 an element.
  device_.require_memory(
      route + (60 * std::size_t{nodes_} + 71 * std::size_t{elements_}) * sizeof(double),
      "a body with tangents of its own", "a smaller mesh or backend cpu");
  create_buffers(options.viscous);
  if (patches_ > 0) create_patches(body);
  create_passes();
  if (options.route == Route::inverse) create_inverse();
  if (options.route == Route::cg) create_cg(body);
}

void FiniteDevice::create_buffers(bool viscous) {
  const auto doubles = [&](std::size_t count) {
    Buffer buffer(device_, std::max<std::size_t>(count, 1) * sizeof(double), Placement::device);
    buffer.fill_zero();
    return buffer;
  };
  for (std::size_t i : {0, 1}) {
    u_[i] = doubles(entries_);
    r_[i] = doubles(unknowns_);
    f_[i] = doubles(2 * std::size_t{entries_});
    stress_[i] = doubles(6 * std::size_t{elements_});
  }
  const std::vector<std::uint32_t> corners = corners_of(problem_);
  nodes_of_ = filled(device_, corners);
  shape_ = filled(device_, shapes_of(problem_));
  fibres_ = filled(device_, fibres_of(problem_));
  facts_ = filled(device_, std::vector<std::uint32_t>(elements_, shaders::kFiniteOut));
  std::vector<std::vector<std::uint32_t>> around(nodes_);
  for (std::uint32_t i = 0; i < corners.size(); ++i) around[corners[i]].push_back(i);
  std::vector<std::uint32_t> first{0}, list;
  for (const auto& of : around) {
    list.insert(list.end(), of.begin(), of.end());
    first.push_back(u32(list.size()));
  }
  first_ = filled(device_, first);
  around_ = filled(device_, list);
  entries_of_ = filled(device_, std::vector<std::uint32_t>(2 * std::size_t{entries_}, 0));
  held_ = filled(device_, std::vector<std::uint32_t>(unknowns_, 0));
  from_ = doubles(viscous ? 6 * std::size_t{elements_} : 1);
  target_ = doubles(2 * std::size_t{unknowns_} + entries_);
  corners_ = doubles(12 * std::size_t{elements_});
  viscous_corners_ = doubles(viscous ? 12 * std::size_t{elements_} : 1);
  const auto parts = [&](std::uint32_t count) {
    return std::size_t{round_up(count, shaders::kGroup)} / shaders::kGroup * kernels_.parts();
  };
  element_partials_ = doubles(parts(elements_) * 4);
  entry_partials_ = doubles(parts(entries_) * 4);
  sums_ = Buffer(device_, sizeof(shaders::FiniteSums), Placement::host);
  if (shares_ > 1) {
    shares_of_sums_ = Buffer(device_, shares_ * sizeof(shaders::FiniteSums), Placement::device);
  }
  du_ = doubles(rows_);
  for (Buffer* pairs : {&s_, &y_}) *pairs = doubles((pairs_ + 1) * std::size_t{unknowns_});
  products_ = Buffer(device_, 16 * sizeof(double), Placement::host);
}

/// The base of L-BFGS.
void FiniteDevice::create_inverse() {
  const auto doubles = [&](std::size_t count) {
    Buffer buffer(device_, std::max<std::size_t>(count, 1) * sizeof(double), Placement::device);
    buffer.fill_zero();
    return buffer;
  };
  for (Buffer* vector : {&q_, &x_}) *vector = doubles(rows_);
  partial_ = doubles(std::size_t{rows_} * (rows_ / shaders::kChunk));
  lengths_ = doubles(16);
  turned_ = filled(device_, std::vector<std::uint32_t>(4 * std::size_t{nodes_}, 0));
  rotations_ = doubles(9 * std::size_t{nodes_});
  inverse_ = Buffer(device_, std::max<std::size_t>(inverse_bytes(kernels_, problem_), 16),
                    Placement::device);
  inverse_.fill_zero();
  make(begin_, "finite_begin", false, {&r_[0], &s_, &y_, &products_, &lengths_, &q_},
       {&r_[1], &s_, &y_, &products_, &lengths_, &q_});
  make(turn_q_, "finite_turn", false, {&turned_, &rotations_, &q_}, {&turned_, &rotations_, &q_});
  make(turn_x_, "finite_turn", false, {&turned_, &rotations_, &x_}, {&turned_, &rotations_, &x_});
  make(product_, "finite_product", true, {&inverse_, &q_, &partial_}, {&inverse_, &q_, &partial_});
  make(fold_, "finite_fold", false, {&partial_, &x_}, {&partial_, &x_});
  make(end_, "finite_end", false, {&x_, &s_, &y_, &products_, &lengths_, &held_, &du_},
       {&x_, &s_, &y_, &products_, &lengths_, &held_, &du_});
  make_rank_room(kFirstRank);  // so that a first event allocates nothing
}

/// For the base's change by what has left.
void FiniteDevice::make_rank_room(std::uint32_t rank) {
  if (rank <= rank_room_) return;
  rank_room_ = std::max({rank, 2 * rank_room_, kFirstRank});
  small_pass_.binding = {};
  columns_.binding = {};
  const std::size_t room = rank_room_;
  touched_ = Buffer(device_, room * sizeof(std::uint32_t), Placement::device);
  small_ = Buffer(device_, room * room * sizeof(double), Placement::device);
  coefficients_ = Buffer(device_, room * sizeof(double), Placement::device);
  bind_base();
}

void FiniteDevice::create_cg(const fem::HyperelasticBody& body) {
  cg_ = std::make_unique<FiniteCg>(kernels_, problem_, body.destroyed,
                                   FiniteCgBody{nodes_of_,
                                                shape_,
                                                fibres_,
                                                facts_,
                                                from_,
                                                first_,
                                                around_,
                                                target_,
                                                corners_,
                                                du_,
                                                {&u_[0], &u_[1]},
                                                {&r_[0], &r_[1]}});
}

void FiniteDevice::make(Pass& pass, std::string_view name, bool real, const Buffers& first,
                        const Buffers& second) {
  const bool one = name == "finite_sums" || name == "finite_sums_join" || name == "finite_begin" ||
                   name == "finite_end";
  const KernelFactory factory = real ? kernels_ : kernels_.in_fp64();
  const std::uint32_t group = one ? kernels_.closing_group() : shaders::kGroup;
  if (!pass.kernel) pass.kernel = factory.make(name, group);
  pass.binding[0] = std::make_unique<vulkan::Binding>(device_, *pass.kernel, first);
  pass.binding[1] = std::make_unique<vulkan::Binding>(device_, *pass.kernel, second);
}

void FiniteDevice::create_passes() {
  make(move_, "finite_move", false, {&entries_of_, &u_[0], &du_, &u_[1]},
       {&entries_of_, &u_[1], &du_, &u_[0]});
  create_law();
  make(gather_, "finite_gather", false,
       {&corners_, &viscous_corners_, &first_, &around_, &entries_of_, &target_, &u_[0], &f_[0],
        &r_[0], &entry_partials_},
       {&corners_, &viscous_corners_, &first_, &around_, &entries_of_, &target_, &u_[1], &f_[1],
        &r_[1], &entry_partials_});
  const Buffer& to = shares_ > 1 ? shares_of_sums_ : sums_;
  make(sum_, "finite_sums", false,
       {&element_partials_, &entry_partials_, &r_[1], &r_[0], &du_, &s_, &y_, &to},
       {&element_partials_, &entry_partials_, &r_[0], &r_[1], &du_, &s_, &y_, &to});
  if (shares_ > 1) {
    make(join_, "finite_sums_join", false, {&shares_of_sums_, &sums_}, {&shares_of_sums_, &sums_});
  }
}

/// As they are now: pieces that have come off have patches of their own.
void FiniteDevice::create_patches(const fem::HyperelasticBody& body) {
  const Patches patches = patches_of(body);
  split_ = body.split;
  patches_ = u32(patches.first.size() - 1);
  patch_first_ = filled(device_, patches.first);
  patch_elements_ = filled(device_, patches.elements);
  pressures_ = Buffer(device_, patches_ * sizeof(shaders::FinitePatch), Placement::device);
}

/// binding[i] evaluates state i against the other one.
void FiniteDevice::create_law() {
  std::array<std::vector<const Buffer*>, 2> law;
  for (std::size_t i : {0, 1}) {
    law[i] = {&u_[i],      &nodes_of_,         &shape_,   &facts_,
              &from_,      &stress_[1 - i],    &corners_, &viscous_corners_,
              &stress_[i], &element_partials_, &fibres_};
    if (patches_ > 0) law[i].push_back(&pressures_);
  }
  make(law_, patches_ > 0 ? "finite_law_pooled" : "finite_law", false, law[0], law[1]);
  if (patches_ == 0) return;
  make(pools_, "finite_pools", false,
       {&u_[0], &nodes_of_, &shape_, &facts_, &patch_first_, &patch_elements_, &pressures_},
       {&u_[1], &nodes_of_, &shape_, &facts_, &patch_first_, &patch_elements_, &pressures_});
}

void FiniteDevice::attach(const solver::RestingBody& body) {
  resting_ = &body;
  known_.clear();
  shown_target_.clear();
  std::vector<std::uint32_t> entries(2 * std::size_t{entries_}), held(unknowns_, 0);
  for (Index d : problem_.gripped_dofs())
    held[static_cast<std::size_t>(d)] = shaders::kFiniteGripped;
  for (std::uint32_t d = 0; d < unknowns_; ++d) {
    if (body.frozen()[d]) held[d] |= shaders::kFiniteFrozen;
  }
  for (std::size_t i = 0; i < entries_; ++i) {
    const Index d = problem_.dofs()[i];
    entries[2 * i] = d == kNone ? shaders::kHeld : static_cast<std::uint32_t>(d);
    entries[2 * i + 1] = d == kNone ? 0 : held[static_cast<std::size_t>(d)];
  }
  facts_.write(std::span<const std::uint32_t>(facts_of(body)));
  if (patches_ > 0 && body.body().split != split_) {
    create_patches(body.body());
    create_law();
  }
  entries_of_.write(std::span<const std::uint32_t>(entries));
  if (unknowns_ > 0) held_.write(std::span<const std::uint32_t>(held));
  if (cg_) cg_->attach(body);
}

/// Writes what differs from what is there.
void FiniteDevice::set_target(const solver::FiniteTarget& target) {
  std::vector<double> all(2 * std::size_t{unknowns_} + entries_, 0.0);
  loaded_squared_ = 0;
  for (std::uint32_t d = 0; d < unknowns_; ++d) {
    all[d] = target.force[d];
    if (target.ahead) all[unknowns_ + d] = target.inertia.of(static_cast<Index>(d));
    if (!resting_->frozen()[d]) loaded_squared_ += target.force[d] * target.force[d];
  }
  if (target.ahead) {
    std::ranges::copy(*target.ahead, all.begin() + 2 * std::ptrdiff_t{unknowns_});
  }
  if (all != shown_target_) {
    target_.write(std::span<const double>(all));
    shown_target_ = std::move(all);
    known_.clear();
  }
  inertia_ = target.ahead && !target.inertia.mass.empty();
  const double viscous = target.viscosity ? target.viscous : 0;
  if (viscous != viscous_) known_.clear();
  viscous_ = viscous;
  if (!target.viscosity ||
      (viscosity_ == target.viscosity && viscous_start_ == target.viscosity->starts())) {
    return;
  }
  viscosity_ = target.viscosity;
  viscous_start_ = target.viscosity->starts();
  known_.clear();
  std::vector<double> from;
  for (const Mat3& of : target.viscosity->from()) {
    from.insert(from.end(), {of(0, 0), of(1, 1), of(2, 2), of(0, 1), of(1, 2), of(2, 0)});
  }
  from_.write(std::span<const double>(from));
}

void FiniteDevice::set_inverse(const Eigen::MatrixXd& inverse) {
  constexpr Eigen::Index kColumns = 256;  // at once
  const bool fp64 = kernels_.fp64();
  std::vector<double> wide;
  std::vector<float> narrow;
  for (Eigen::Index first = 0; first < inverse.cols(); first += kColumns) {
    const Eigen::Index count = std::min(kColumns, inverse.cols() - first);
    const auto block = inverse.middleCols(first, count);
    const std::size_t begin = static_cast<std::size_t>(first) * rows_,
                      size = static_cast<std::size_t>(count) * rows_;
    if (fp64) {
      wide.assign(size, 0.0);
      Eigen::Map<Eigen::MatrixXd>(wide.data(), rows_, count).topRows(inverse.rows()) = block;
      inverse_.write(std::span<const double>(wide), begin);
    } else {
      narrow.assign(size, 0.0F);
      Eigen::Map<Eigen::MatrixXf>(narrow.data(), rows_, count).topRows(inverse.rows()) =
          block.cast<float>();
      inverse_.write(std::span<const float>(narrow), begin);
    }
  }
}

void FiniteDevice::bind_base() {
  make(small_pass_, "finite_small", false, {&small_, &touched_, &x_, &coefficients_},
       {&small_, &touched_, &x_, &coefficients_});
  make(columns_, "finite_columns", true, {&inverse_, &touched_, &coefficients_, &x_},
       {&inverse_, &touched_, &coefficients_, &x_});
}

void FiniteDevice::set_base(const solver::FiniteBase& base) {
  const auto& now = base.stamps();
  if (now.inverse != stamps_.inverse) set_inverse(base.inverse());
  if (now.small != stamps_.small || now.inverse != stamps_.inverse) {
    rank_ = static_cast<std::uint32_t>(base.rank());
    make_rank_room(rank_);
    if (rank_ > 0) {
      const std::vector<std::uint32_t> touched(base.touched().begin(), base.touched().end());
      touched_.write(std::span<const std::uint32_t>(touched));
      const Eigen::MatrixXd& m = base.small();
      small_.write(std::span<const double>(m.data(), static_cast<std::size_t>(m.size())));
    }
  }
  if (now.turned != stamps_.turned) {
    std::vector<std::uint32_t> places;
    std::vector<double> rotations;
    for (const auto& turned : base.turned()) {
      for (Index d : turned.unknowns) places.push_back(static_cast<std::uint32_t>(d));
      places.push_back(0);
      rotations.insert(rotations.end(), turned.q.data(), turned.q.data() + 9);
    }
    turned_count_ = u32(base.turned().size());
    if (turned_count_ > 0) {
      turned_.write(std::span<const std::uint32_t>(places));
      rotations_.write(std::span<const double>(rotations));
    }
  }
  stamps_ = now;
}

FinitePush FiniteDevice::push() const {
  FinitePush of{};
  of.viscous = viscous_;
  of.elements = elements_;
  of.entries = entries_;
  of.unknowns = unknowns_;
  of.element_parts = round_up(elements_, shaders::kGroup) / shaders::kGroup * kernels_.parts();
  of.entry_parts = round_up(entries_, shaders::kGroup) / shaders::kGroup * kernels_.parts();
  of.biot = options_.stress == StressMeasure::biot ? 1 : 0;
  of.pairs = u32(order_.size());
  of.slot = slot_;
  for (std::size_t k = 0; k < order_.size(); ++k) of.order |= order_[k] << (4 * k);
  of.rank = rank_;
  of.turned = turned_count_;
  of.shares = shares_;
  of.patches = patches_;
  return of;
}

/// A pass with `count` invocations, or of one workgroup.
void FiniteDevice::over(const Pass& pass, const FinitePush& push, std::uint32_t count,
                        std::uint32_t rows) {
  const std::uint32_t groups = round_up(count, shaders::kGroup) / shaders::kGroup;
  commands_.dispatch(*pass.binding[first_state_], push, std::max(groups, 1U), rows);
}

void FiniteDevice::record_direction() {
  FinitePush push = this->push();
  commands_.pass("direction");
  over(begin_, push, 1);
  push.back = 1;
  if (turned_count_ > 0) over(turn_q_, push, turned_count_);
  push.back = 0;
  commands_.pass("base");
  over(product_, push, rows_ / 4, rows_ / shaders::kChunk);
  over(fold_, push, unknowns_);
  if (rank_ > 0) {
    over(small_pass_, push, rank_);
    over(columns_, push, unknowns_);
  }
  if (turned_count_ > 0) over(turn_x_, push, turned_count_);
  commands_.pass("direction");
  over(end_, push, 1);
}

/// Of the second state, or of the first one.
void FiniteDevice::record_evaluation(const FinitePush& push, bool next) {
  const std::size_t which = next ? 1 - first_state_ : first_state_;
  const auto dispatch = [&](const Pass& pass, std::uint32_t count) {
    commands_.dispatch(*pass.binding[which], push,
                       round_up(count, shaders::kGroup) / shaders::kGroup);
  };
  commands_.pass("internal forces");
  if (patches_ > 0) dispatch(pools_, patches_);
  dispatch(law_, elements_);
  dispatch(gather_, entries_);
  dispatch(sum_, shares_ * shaders::kGroup);
  if (shares_ > 1) dispatch(join_, 1);
}

solver::FinitePoint FiniteDevice::point() const {
  const shaders::FiniteSums& of = *sums_.mapped<shaders::FiniteSums>();
  return {of.energy + of.viscous + of.springs, std::sqrt(of.residual_squared),
          std::sqrt(loaded_squared_ + of.held_squared + (inertia_ ? of.inertia_squared : 0))};
}

/// The first state <- u, evaluated.
void FiniteDevice::set_state(std::span<const double> u) {
  if (known_.size() == u.size() && std::ranges::equal(known_, u)) return;
  known_.clear();
  u_[first_state_].write(u);
  commands_.begin();
  record_evaluation(push(), false);
  commands_.end();
  commands_.submit();
  known_.assign(u.begin(), u.end());
}

/// All of the first state but what the last sums say.
void FiniteDevice::read(solver::FiniteState& state, bool with_displacement, bool with_stress) {
  state.f.resize(entries_);
  state.viscous.resize(viscous_ > 0 ? entries_ : 0);
  state.r.resize(unknowns_);
  state.stress.resize(with_stress ? elements_ : 0);
  std::array<Buffer::Part, 5> parts{
      Buffer::Part{f_[first_state_], 0, state.f},
      Buffer::Part{f_[first_state_], entries_, state.viscous},
      Buffer::Part{r_[first_state_], 0, {state.r.data(), unknowns_}},
      Buffer::Part{stress_[first_state_], 0, numbers_of(state.stress)},
      Buffer::Part{u_[first_state_], 0, state.u}};
  Buffer::read_all(std::span(parts).first(with_displacement ? 5 : 4));
}

void FiniteDevice::evaluate(const solver::FiniteTarget& target, bool with_stress,
                            solver::FiniteState& state) {
  set_target(target);
  known_.clear();  // the sums are those of another state
  set_state(state.u);
  const solver::FinitePoint at = point();
  state.energy = sums_.mapped<shaders::FiniteSums>()->energy;
  state.potential = at.potential;
  state.acting = at.acting;
  read(state, false, with_stress);
}

void FiniteDevice::stress(std::span<const double> u, std::span<Voigt> stress) {
  if (stress.empty()) return;
  set_state(u);
  stress_[first_state_].read(numbers_of(stress));
}

solver::FinitePoint FiniteDevice::begin(const solver::FiniteTarget& target,
                                        solver::FiniteBase* base, solver::FiniteState& state) {
  set_target(target);
  if (base) set_base(*base);
  if (cg_) cg_->begin(state.u, target.inertia);
  order_.clear();
  slot_ = 0;
  state_ = &state;
  set_state(state.u);
  return {state.potential, state.r.norm(), state.acting};
}

solver::FiniteTrial FiniteDevice::trial(double part, bool direction) {
  commands_.begin();
  if (direction && cg_) cg_->record(commands_, this->push(), first_state_);
  if (direction && !cg_) record_direction();
  FinitePush push = this->push();
  push.part = part;
  over(move_, push, entries_);
  record_evaluation(push, true);
  commands_.end();
  commands_.submit();
  if (direction && cg_) {
    cg_->learn();
    inner_iterations_ += static_cast<std::size_t>(cg_->iterations());
  }
  const shaders::FiniteSums& of = *sums_.mapped<shaders::FiniteSums>();
  return {point(), of.slope, of.s_y, std::sqrt(of.change_squared), std::sqrt(of.stress_squared)};
}

solver::FiniteDevice::Needs FiniteDevice::needs() const {
  if (cg_) return Needs::nothing;
  return options_.route == Route::inverse ? Needs::inverse : Needs::host;
}

solver::FiniteTrial FiniteDevice::whole(bool) { return trial(1, true); }
solver::FiniteTrial FiniteDevice::part(double of, bool) { return trial(of, false); }

void FiniteDevice::take() {
  const shaders::FiniteSums& of = *sums_.mapped<shaders::FiniteSums>();
  first_state_ = 1 - first_state_;
  known_.clear();
  state_->energy = of.energy;
  const solver::FinitePoint at = point();
  state_->potential = at.potential;
  state_->acting = at.acting;
  // As Lbfgs::learn.
  if (pairs_ == 0 || !(of.s_y > 1e-12 * std::sqrt(of.s_squared) * std::sqrt(of.y_squared))) return;
  products_.mapped<double>()[slot_] = of.s_y;
  if (order_.size() == pairs_) order_.erase(order_.begin());
  order_.push_back(slot_);
  slot_ = 0;
  while (std::ranges::find(order_, slot_) != order_.end()) ++slot_;
}

void FiniteDevice::end() {
  solver::FiniteState& state = *state_;
  if (known_.empty()) {
    read(state, true, true);
    known_ = state.u;
  }
}

std::vector<BufferPlan> FiniteDevice::buffers() const {
  const std::size_t states =
      2 * (u_[0].bytes() + r_[0].bytes() + f_[0].bytes() + stress_[0].bytes());
  const std::size_t vectors =
      du_.bytes() + q_.bytes() + x_.bytes() + partial_.bytes() + s_.bytes() + y_.bytes();
  const std::size_t body = nodes_of_.bytes() + shape_.bytes() + fibres_.bytes() + facts_.bytes() +
                           first_.bytes() + around_.bytes() + entries_of_.bytes() + held_.bytes() +
                           from_.bytes() + target_.bytes() + corners_.bytes() +
                           viscous_corners_.bytes() + patch_first_.bytes() +
                           patch_elements_.bytes() + pressures_.bytes();
  std::vector<BufferPlan> list;
  if (inverse_.bytes() > 0) {
    list.push_back({"dense inverse of a recent tangent (device)", inverse_.bytes()});
  }
  if (cg_) list = cg_->buffers();
  for (BufferPlan& plan :
       std::vector<BufferPlan>{{"two states of the body (device)", states},
                               {"vectors of steps (device)", vectors},
                               {"mesh, laws and corner forces (device)", body}}) {
    list.push_back(std::move(plan));
  }
  return list;
}

}  // namespace sunder::gpu
