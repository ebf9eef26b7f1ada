// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/fields.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "body/element.hpp"
#include "body/pools.hpp"
#include "gpu/passes/two_floats.hpp"
#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

}  // namespace

Fields::Fields(const KernelFactory& kernels, const Problem& problem, const Needs& needs,
               const RouteNeeds& route)
    : kernels_(kernels),
      problem_(problem),
      keep_stress_(needs.stress),
      list_over_(needs.yield),
      norms_(needs.stress || needs.yield || needs.damage || kernels.single()),
      has_residual_(route.residual),
      has_along_(route.along),
      rows_(round_up(static_cast<std::uint32_t>(problem.dof_count()), shaders::kRowPad)),
      elements_(round_up(static_cast<std::uint32_t>(problem.tet_count()), shaders::kGroup)),
      nodes_(round_up(static_cast<std::uint32_t>(problem.node_count()), shaders::kGroup)),
      element_parts_(elements_ / shaders::kGroup * kernels.parts()),
      node_parts_(nodes_ / shaders::kGroup * kernels.parts()),
      gripped_(problem.gripped_dofs().begin(), problem.gripped_dofs().end()),
      matrix_(problem) {
  vulkan::Device& device = kernels.device();
  if (problem.pools() && kernels.single()) {
    throw DeviceError("the device \"" + device.physical().name +
                      "\" lacks shaderFloat64, which pooled volume (volume = \"pooled\") needs; "
                      "use another device or backend cpu");
  }
  device.require_memory(planned_bytes(route.preconditioner) + route.bytes, "this scene");
  if (has_residual_ && kernels.single()) {
    host_balance_ = std::make_unique<HostBalance>(problem);
  } else if (has_residual_) {
    matrix_.upload(kernels, route.preconditioner);
  }
  const auto make = [&](std::size_t bytes, Placement placement = Placement::device) {
    Buffer buffer(device, bytes, placement);
    buffer.fill_zero();
    return buffer;
  };
  const std::size_t nodal_bytes = (std::size_t{4} * nodes_ + rows_) * sizeof(double);
  displacement_ = make(nodal_bytes);
  kept_ = make(nodal_bytes);
  correction_ = make(nodal_bytes);
  load_ = make(std::size_t{4} * nodes_ * sizeof(double), Placement::sent);
  residual_ = make(rows_ * sizeof(double));
  balance_ = make(std::size_t{4} * nodes_ * sizeof(double));
  stress_ = make(keep_stress_ ? std::size_t{elements_} * 8 * kernels.real_bytes() : 16);
  over_ = make((1 + (norms_ ? std::size_t{elements_} : 0)) * sizeof(std::uint32_t));
  stress_partials_ = make((norms_ ? element_parts_ : 1) * sizeof(shaders::StressPartial));
  node_partials_ = make(node_parts_ * sizeof(shaders::NodePartial));
  summaries_ = make(2 * sizeof(shaders::Summary), Placement::host);
  if (has_along_) along_ = ReadAlong(device, std::size_t{4} * nodes_ * sizeof(double));
  upload_mesh();
  if (norms_) upload_shapes();
  create_kernels();
  create_hold();
}

std::size_t Fields::planned_bytes(bool preconditioner) const {
  const std::size_t nodal = std::size_t{4} * nodes_ * sizeof(double);
  const std::size_t unknowns = rows_ * sizeof(double);
  const std::size_t elements = elements_, grips = problem_.gripped_dofs().size();
  std::size_t sum = kernels_.single() || !has_residual_ ? 0 : matrix_.planned_bytes(preconditioner);
  for (const std::size_t bytes :
       {3 * (nodal + unknowns),  // displacement, kept, correction
        2 * nodal + unknowns,    // load, balance; residual
        keep_stress_ ? elements * 8 * kernels_.real_bytes() : 16,
        (1 + (norms_ ? elements : 0)) * sizeof(std::uint32_t),  // over yield
        (norms_ ? element_parts_ : 1) * sizeof(shaders::StressPartial),
        node_parts_ * sizeof(shaders::NodePartial), 2 * sizeof(shaders::Summary),
        elements * sizeof(shaders::ElementFacts),
        std::size_t{4} * nodes_ * sizeof(std::uint32_t),  // dofs
        rows_ * sizeof(std::uint32_t)}) {                 // positions
    sum += Buffer::padded(bytes);
  }
  sum += SummaryPass::planned_bytes(kernels_, most_parts());
  if (has_along_) sum += ReadAlong::planned_bytes(kernels_.device().physical(), nodal);
  if (norms_) {  // nodes and shapes of elements
    sum += Buffer::padded(4 * elements * sizeof(std::uint32_t)) +
           Buffer::padded(12 * elements * sizeof(double));
  }
  if (norms_) sum += PatchPressures::planned_bytes(problem_);
  if (grips > 0) {
    sum += Buffer::padded(grips * sizeof(std::uint32_t)) + Buffer::padded(grips * sizeof(double));
  }
  return sum;
}

void Fields::upload_mesh() {
  std::vector<std::uint32_t> nodes_of(std::size_t{4} * elements_, 0);
  facts_host_.assign(elements_, {shaders::kAbsent, 0, 0, 0});
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    for (int a = 0; a < 4; ++a) {
      nodes_of[4 * static_cast<std::size_t>(e) + a] =
          static_cast<std::uint32_t>(problem_.mesh().tets[e][a]);
    }
    const double of_element = problem_.breakable(e) ? problem_.yield(e) : 1.0;
    const auto yield = kernels_.single()
                           ? std::bit_cast<std::uint32_t>(static_cast<float>(of_element))
                           : std::bit_cast<std::uint64_t>(of_element);
    const Index patch = problem_.pools() ? problem_.pools()->of(e) : kNone;
    facts_host_[static_cast<std::size_t>(e)] = {
        problem_.breakable(e) ? shaders::kBreakable : 0,
        patch == kNone ? 0 : static_cast<std::uint32_t>(patch) + 1,
        static_cast<std::uint32_t>(yield), static_cast<std::uint32_t>(yield >> 32)};
  }
  // Padding rows write behind the nodes, where nothing reads.
  std::vector<std::uint32_t> positions(rows_);
  for (std::uint32_t i = 0; i < rows_; ++i) positions[i] = 4 * nodes_ + i;
  for (Index n = 0; n < problem_.node_count(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index dof = problem_.dof(n, axis);
      if (dof != kNone) positions[dof] = static_cast<std::uint32_t>(4 * n + axis);
    }
  }
  const auto upload = [&](Buffer& buffer, const std::vector<std::uint32_t>& words) {
    buffer = Buffer(kernels_.device(), words.size() * sizeof(std::uint32_t), Placement::device);
    buffer.write(std::span<const std::uint32_t>(words));
  };
  if (norms_) upload(nodes_of_, nodes_of);
  facts_ = Buffer(kernels_.device(), facts_host_.size() * sizeof(shaders::ElementFacts),
                  Placement::device);
  facts_.write(std::span<const shaders::ElementFacts>(facts_host_));
  dofs_ =
      Buffer(kernels_.device(), std::size_t{4} * nodes_ * sizeof(std::uint32_t), Placement::device);
  upload_dofs();
  upload(positions_, positions);
  place_ = std::move(positions);
}

/// Unknowns of the nodes, and which axes are gripped.
void Fields::upload_dofs() {
  std::vector<std::uint8_t> gripped(static_cast<std::size_t>(problem_.dof_count()), 0);
  for (Index d : gripped_) gripped[static_cast<std::size_t>(d)] = 1;
  std::vector<std::uint32_t> dofs(std::size_t{4} * nodes_, shaders::kHeld);
  for (std::uint32_t n = 0; n < nodes_; ++n) {
    dofs[4 * n + 3] = 0;
    if (n >= static_cast<std::uint32_t>(problem_.node_count())) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const Index dof = problem_.dof(static_cast<Index>(n), axis);
      if (dof == kNone) continue;
      dofs[4 * n + axis] = static_cast<std::uint32_t>(dof);
      if (gripped[static_cast<std::size_t>(dof)]) dofs[4 * n + 3] |= 1u << axis;
    }
  }
  dofs_.write(std::span<const std::uint32_t>(dofs));
}

void Fields::grip(std::span<const Index> gripped, std::span<const double> scale) {
  gripped_.assign(gripped.begin(), gripped.end());
  if (host_balance_) host_balance_->grip(gripped_);
  if (has_residual_ && !host_balance_) matrix_.grip(gripped_, scale);
  upload_dofs();
  create_hold();
}

void Fields::upload_shapes() {
  std::vector<double> shape(std::size_t{12} * elements_, 0.0);
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    const TetShape& s = problem_.shape(e);
    const SmallStrain m = fem::own_law(problem_, e);
    const std::array<double, 3> last = {m.lambda, m.mu, s.volume};
    for (int corner = 1; corner < 4; ++corner) {
      double* to = &shape[12 * static_cast<std::size_t>(e) + 4 * (corner - 1)];
      for (int axis = 0; axis < 3; ++axis) to[axis] = s.gradient(axis, corner);
      to[3] = last[corner - 1];
    }
  }
  shape_ = Buffer(kernels_.device(), shape.size() * sizeof(double), Placement::device);
  write_wide(kernels_, shape_, shape);
}

void Fields::create_kernels() {
  vulkan::Device& device = kernels_.device();
  if (norms_ && problem_.pools()) {
    pools_ = std::make_unique<PatchPressures>(
        kernels_, problem_,
        PatchPressures::Inputs{{&displacement_, &correction_}, nodes_of_, shape_, facts_});
  }
  const auto stress_of = [&](const Buffer& u) {
    std::vector<const Buffer*> list{&u,       &nodes_of_,        &shape_, &facts_,
                                    &stress_, &stress_partials_, &over_};
    if (pools_) list.push_back(&pools_->pressures());
    return std::make_unique<vulkan::Binding>(device, *stress_pass_.kernel, list);
  };
  if (norms_) {
    stress_pass_.kernel = kernels_.make(pools_ ? "stress_pooled" : "stress");
    stress_pass_.binding = stress_of(displacement_);
    correction_stress_ = stress_of(correction_);
  }
  if (has_residual_ && !host_balance_) create_residual_pass();
  summary_pass_ = std::make_unique<SummaryPass>(
      kernels_, most_parts(), SummaryBuffers{stress_partials_, node_partials_, summaries_, over_});
  displacement_gather_ = std::make_unique<Gather>(kernels_, displacement_);
}

void Fields::create_residual_pass() {
  const PatchVectors& patches = matrix_.patches();
  residual_pass_.kernel = kernels_.make_fp64(patches.empty() ? "residual" : "residual_pooled");
  std::vector<const Buffer*> buffers{
      &displacement_, &matrix_.blocks(), &matrix_.slices(), &dofs_,
      &load_,         &balance_,         &residual_,        &node_partials_};
  if (!patches.empty()) {
    patches.append_to(buffers);
    patch_sums_.kernel = kernels_.make_fp64("patch_sums");
    patch_sums_.binding = patches.bind_sums(kernels_, *patch_sums_.kernel, displacement_);
  }
  residual_pass_.binding =
      std::make_unique<vulkan::Binding>(kernels_.device(), *residual_pass_.kernel, buffers);
  balance_gather_ = std::make_unique<Gather>(kernels_, balance_);
}

shaders::ElementPush Fields::element_push(std::uint32_t keep) const {
  const FractureOptions& fracture = problem_.scene().fracture;
  const auto alpha = static_cast<float>(fracture.alpha);
  return {alpha, static_cast<float>(fracture.alpha - static_cast<double>(alpha)), keep,
          static_cast<std::uint32_t>(strength_measure(fracture))};
}

void Fields::set_load(std::span<const double> force, std::span<const double> displacements) {
  if (host_balance_) {
    host_balance_->set_load(force);
  } else {
    auto* load = load_.mapped<double>();
    for (Index d = 0; d < problem_.dof_count(); ++d) load[place_[d]] = force[d];
  }
  if (!displacements.empty()) write_wide(kernels_, prescribed_, displacements);
}

void Fields::read_wide(const Buffer& buffer, std::span<double> values, std::size_t first) const {
  buffer.read(values, first);
  if (kernels_.single()) join_two_floats(values);
}

void Fields::balance_on_host() {
  std::vector<double> nodal(3 * problem_.mesh().nodes.size());
  read_displacement(nodal);
  host_balance_->compute(nodal);
}

shaders::Summary Fields::summary(std::size_t slot) const {
  if (!kernels_.single()) return summaries_.mapped<shaders::Summary>()[slot];
  const auto s = summaries_.mapped<shaders::SummaryOf<float>>()[slot];
  shaders::Summary wide{};
  wide.any_ratio = static_cast<double>(s.any_ratio);
  wide.candidate_ratio = static_cast<double>(s.candidate_ratio);
  wide.stress_squared = static_cast<double>(s.stress_squared);
  wide.any_element = s.any_element;
  wide.candidate_element = s.candidate_element;
  wide.over = s.over;
  wide.strain = s.strain;
  wide.half_tangent = s.half_tangent;
  wide.inverted = s.inverted;
  wide.handed_out = s.handed_out;
  return wide;
}

Deformation Fields::deformation() const {
  const shaders::Summary s = summary(0);
  const auto strain = static_cast<double>(std::bit_cast<float>(s.strain & ~1u));
  const auto half_tangent = static_cast<double>(std::bit_cast<float>(s.half_tangent));
  return {(s.strain & 1u) != 0 ? -strain : strain, 360 / std::numbers::pi * std::atan(half_tangent),
          static_cast<Index>(s.inverted)};
}

shaders::Summary Fields::state() const {
  shaders::Summary s = summary(0);
  if (host_balance_) {
    s.residual_squared = host_balance_->residual_squared();
    s.reaction_squared = host_balance_->reaction_squared();
    s.largest_u = host_balance_->largest_u();
  }
  return s;
}

double Fields::largest_stress(Field field) const {
  if (norms_) return std::sqrt(summary(field == Field::displacement ? 0 : 1).stress_squared);
  std::vector<double> u(3 * problem_.mesh().nodes.size());
  read(field, u);
  double largest = 0;
  const fem::StressField stress(problem_, {}, u);  // nothing breaks where norms are left out
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    const double norm = tensor(stress.of(e)).norm();
    if (!std::isfinite(norm)) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, norm);
  }
  return largest;
}

double Fields::handed_out() const {
  constexpr double kUnit = 0x1p-24;  // roundoff of fp32, by which the kernel counts
  return norms_ ? kUnit * static_cast<double>(summary(0).handed_out) : 0.0;
}

bool Fields::finite() const {
  const shaders::Summary s = state();
  return std::isfinite(norms_ ? s.stress_squared : s.residual_squared);
}

void Fields::write_residual(std::span<const double> residual) {
  if (kernels_.single()) {
    const std::vector<float> rounded(residual.begin(), residual.end());
    residual_.write(std::span<const float>(rounded));
  } else {
    residual_.write(residual);
  }
}

void Fields::write_unknowns(Field field, const Eigen::VectorXd& values) {
  std::vector<double> padded(4 * problem_.mesh().nodes.size(), 0.0);
  for (Index d = 0; d < problem_.dof_count(); ++d) padded[place_[d]] = values[d];
  write_wide(kernels_, nodal(field), padded);
}

std::vector<Index> Fields::over_yield() const {
  std::vector<std::uint32_t> found(state().over);
  over_.read(std::span<std::uint32_t>(found), 1);
  std::sort(found.begin(), found.end());
  return {found.begin(), found.end()};
}

void Fields::create_hold() {
  if (gripped_.empty()) return;
  vulkan::Device& device = kernels_.device();
  std::vector<std::uint32_t> held;
  for (Index d : gripped_) held.push_back(place_[d]);
  held_ = Buffer(device, held.size() * sizeof(std::uint32_t), Placement::device);
  held_.write(std::span<const std::uint32_t>(held));
  prescribed_ = Buffer(device, held.size() * sizeof(double), Placement::sent);
  if (!hold_pass_.kernel) hold_pass_.kernel = kernels_.make_fp64("hold");
  const Buffer* of_displacement[] = {&held_, &prescribed_, &displacement_};
  const Buffer* of_correction[] = {&held_, &prescribed_, &correction_};
  hold_pass_.binding =
      std::make_unique<vulkan::Binding>(device, *hold_pass_.kernel, of_displacement);
  correction_hold_ = std::make_unique<vulkan::Binding>(device, *hold_pass_.kernel, of_correction);
}

void Fields::record_keep(vulkan::Commands& commands) {
  if (!keep_) return;
  keep_ = false;
  commands.copy(displacement_.handle(), displacement_.offset(), kept_.handle(), kept_.offset(),
                displacement_.bytes());
}

void Fields::restore() {
  vulkan::Commands commands(kernels_.device());
  commands.begin();
  commands.copy(kept_.handle(), kept_.offset(), displacement_.handle(), displacement_.offset(),
                displacement_.bytes());
  record_state(commands);
  commands.end();
  commands.submit();
  if (host_balance_) balance_on_host();
}

void Fields::renew_state() {
  vulkan::Commands commands(kernels_.device());
  commands.begin();
  record_state(commands);
  commands.end();
  commands.submit();
}

void Fields::record_hold(vulkan::Commands& commands, Field field) const {
  const auto count = static_cast<std::uint32_t>(gripped_.size());
  if (count == 0) return;
  const bool correction = field == Field::correction;
  commands.dispatch(correction ? *correction_hold_ : *hold_pass_.binding,
                    shaders::HoldPush{count, correction ? 1u : 0u},
                    round_up(count, shaders::kGroup) / shaders::kGroup);
}

void Fields::set_state_bits(std::span<const Index> elements, std::uint32_t bits) {
  for (Index e : elements) {
    const auto at = static_cast<std::size_t>(e);
    facts_host_[at].state |= bits;
    facts_.write(std::span<const shaders::ElementFacts>(&facts_host_[at], 1), at);
  }
}

void Fields::destroy(std::span<const Index> elements, std::span<const double> scale,
                     const fem::Pools* now) {
  if (host_balance_) {
    host_balance_->scale_by(scale);
  } else if (has_residual_) {
    matrix_.destroy(elements, scale, now);
  }
  set_state_bits(elements, shaders::kDestroyed);
  if (pools_) split_pools(now ? *now : *problem_.pools());
}

/// Where they are other patches than before.
void Fields::split_pools(const fem::Pools& now) {
  bool others = false;
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    const auto at = static_cast<std::size_t>(e);
    const auto patch = static_cast<std::uint32_t>(now.of(e) + 1);  // kNone: 0
    if (facts_host_[at].patch_number == patch) continue;
    facts_host_[at].patch_number = patch;
    facts_.write(std::span<const shaders::ElementFacts>(&facts_host_[at], 1), at);
    others = true;
  }
  if (others) pools_->split(now);
}

void Fields::exclude(std::span<const Index> elements) {
  set_state_bits(elements, shaders::kExcluded);
}

void Fields::cut_off(std::span<const Index> elements) {
  set_state_bits(elements, shaders::kCutOff);
}

/// With the pressures of patches before it.
void Fields::record_stress(vulkan::Commands& commands, Field field, std::uint32_t keep) const {
  const bool correction = field == Field::correction;
  if (pools_) pools_->record(commands, correction ? 1 : 0, element_push(keep));
  commands.dispatch(correction ? *correction_stress_ : *stress_pass_.binding, element_push(keep),
                    elements_ / shaders::kGroup);
}

void Fields::record_state(vulkan::Commands& commands, bool balance) {
  balance = (balance || !norms_) && has_residual_ && !host_balance_;
  const std::uint32_t node_groups = nodes_ / shaders::kGroup;
  if (norms_) {
    commands.pass("stress");
    record_stress(commands, Field::displacement,
                  (keep_stress_ ? shaders::kKeepStress : 0) |
                      (list_over_ ? shaders::kListOver : 0) | (shown_ ? shaders::kShown : 0));
  }
  if (balance) {
    commands.pass("residual");
    if (patch_sums_.binding) commands.dispatch(*patch_sums_.binding, matrix_.patches().groups());
    commands.dispatch(*residual_pass_.binding, node_groups);
  }
  commands.pass(norms_ ? "stress" : "residual");
  summary_pass_->record(commands, {norms_ ? element_parts_ : 0, balance ? node_parts_ : 0}, 0);
  along_.record(commands, displacement_, residual_);
}

void Fields::record_correction(vulkan::Commands& commands) const {
  if (!norms_) return;
  commands.pass("estimate");
  record_stress(commands, Field::correction, 0);
  summary_pass_->record(commands, {element_parts_, 0}, 1);
}

void Fields::write_displacement(std::span<const double> nodal) {
  std::vector<double> padded(4 * problem_.mesh().nodes.size(), 0.0);
  for (std::size_t n = 0; n < problem_.mesh().nodes.size(); ++n) {
    std::copy_n(&nodal[3 * n], 3, &padded[4 * n]);
  }
  write_wide(kernels_, displacement_, padded);
}

void Fields::read(Field field, std::span<double> nodal) const {
  std::vector<double> padded(4 * problem_.mesh().nodes.size());
  const Buffer& there = this->nodal(field);
  read_wide(
      field == Field::displacement ? along_.where(ReadAlong::What::displacement, there) : there,
      padded);
  for (std::size_t n = 0; n < problem_.mesh().nodes.size(); ++n) {
    std::copy_n(&padded[4 * n], 3, &nodal[3 * n]);
  }
}

void Fields::read_residual(std::span<double> residual) const {
  along_.where(ReadAlong::What::residual, residual_).read(residual);
}

Eigen::VectorXd Fields::read_unknowns(Field field, std::span<const Index> dofs) const {
  std::vector<double> padded(4 * problem_.mesh().nodes.size());
  read_wide(nodal(field), padded);
  Eigen::VectorXd values(static_cast<Index>(dofs.size()));
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    values[static_cast<Index>(i)] = padded[place_[dofs[i]]];
  }
  return values;
}

Vec3 Fields::read_displacement(Index node) const {
  std::array<double, 4> value{};
  read_wide(displacement_, value, 4 * static_cast<std::size_t>(node));
  return {value[0], value[1], value[2]};
}

void Fields::read_displacement(std::span<const Index> nodes, std::span<Vec3> displacement) const {
  std::vector<std::uint32_t> places;
  places.reserve(3 * nodes.size());
  for (Index n : nodes) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      places.push_back(4 * static_cast<std::uint32_t>(n) + axis);
    }
  }
  std::vector<double> values(places.size());
  displacement_gather_->read(places, values);
  for (std::size_t i = 0; i < nodes.size(); ++i) displacement[i] = Vec3(&values[3 * i]);
}

namespace {

template <class T>
Voigt to_voigt(const T* v) {
  Voigt s;
  for (int i = 0; i < 6; ++i) s[i] = static_cast<double>(v[i]);
  return s;
}

template <class T>
void read_elements(const Buffer& buffer, std::size_t first, std::span<Voigt> stress) {
  std::vector<T> values(8 * stress.size());
  buffer.read(std::span<T>(values), 8 * first);
  for (std::size_t e = 0; e < stress.size(); ++e) stress[e] = to_voigt(&values[8 * e]);
}

}  // namespace

void Fields::read_stress(std::span<Voigt> stress) const {
  if (kernels_.fp64()) {
    read_elements<double>(stress_, 0, stress);
  } else {
    read_elements<float>(stress_, 0, stress);
  }
}

Voigt Fields::read_stress(Index element) const {
  std::array<Voigt, 1> one;
  if (kernels_.fp64()) {
    read_elements<double>(stress_, static_cast<std::size_t>(element), one);
  } else {
    read_elements<float>(stress_, static_cast<std::size_t>(element), one);
  }
  return one[0];
}

void Fields::read_reactions(std::span<const Index> dofs, std::span<double> reactions) const {
  if (dofs.empty()) return;
  if (host_balance_) {
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      reactions[i] = -host_balance_->balance()[dofs[i]];
    }
    return;
  }
  std::vector<std::uint32_t> places;
  for (Index d : dofs) places.push_back(place_[d]);
  balance_gather_->read(places, reactions);
  for (double& r : reactions) r = -r;
}

std::vector<BufferPlan> Fields::buffers() const {
  const auto sum = [](std::initializer_list<const Buffer*> list) {
    std::size_t bytes = 0;
    for (const Buffer* b : list) bytes += b->bytes();
    return bytes;
  };
  return {
      {"mesh and element state (device)",
       sum({&nodes_of_, &shape_, &facts_, &dofs_, &positions_}) + (pools_ ? pools_->bytes() : 0)},
      {"displacement, correction, load, residual (device)",
       sum({&displacement_, &kept_, &correction_, &load_, &residual_, &balance_})},
      {"stiffness, 3 x 3 blocks with preconditioner (device)", matrix_.bytes()},
      {"element stress (device)", stress_.bytes()},
      {"partial results and summary (device)",
       sum({&stress_partials_, &node_partials_, &summaries_, &over_}) + summary_pass_->bytes() +
           along_.bytes()}};
}

}  // namespace sunder::gpu
