// SPDX-License-Identifier: Apache-2.0
#include "gpu/device_body.hpp"

#include <algorithm>

#include "fem/element.hpp"
#include "gpu/cg_route.hpp"
#include "gpu/host_corrected_route.hpp"

namespace sunder::gpu {
namespace {

// Read back node by node up to here, gathered on the device beyond.
constexpr std::size_t kFewNodes = 64;

Fields::RouteNeeds route_needs(const DeviceSetup& setup, const Problem& part) {
  const KernelFactory& kernels = setup.kernels;
  if (setup.plan.cg) return {CgRoute::planned_bytes(kernels, part), true};
  if (kernels.single()) {
    return {HostCorrectedRoute::planned_bytes(kernels, part, setup.inverse.panel_bytes), false};
  }
  return {InverseRoute::planned_bytes(kernels, part, setup.inverse), false};
}

}  // namespace

DeviceBody::DeviceBody(const DeviceSetup& setup, std::shared_ptr<const Problem> whole,
                       std::optional<engine::Region> region, std::future<IntactInverse> started)
    : kernels_(setup.kernels), whole_(*whole), part_(std::move(whole)) {
  if (region) {
    region_ = std::make_unique<engine::Substructure>(whole_, std::move(*region));
    part_ = region_->part();
  }
  damaged_ = std::make_unique<engine::DamagedBody>(part_);
  fields_ =
      std::make_unique<Fields>(setup.kernels, *part_, setup.needs, route_needs(setup, *part_));
  prepare_intact(setup, std::move(started));
  make_route(setup);
}

void DeviceBody::prepare_intact(const DeviceSetup& setup, std::future<IntactInverse> started) {
  const bool cg = setup.plan.cg, pristine = setup.needs.pristine;
  if (!cg || pristine) {
    intact_ = started.valid()
                  ? started.get()
                  : std::make_shared<const HostInverse>(*part_, std::span<const double>{},
                                                        !cg && !setup.inverse.on_device);
  }
  if (pristine) pristine_ = intact_update(*part_, intact_);
}

void DeviceBody::make_route(const DeviceSetup& setup) {
  const KernelFactory& kernels = setup.kernels;
  if (setup.plan.cg) {
    route_ = std::make_unique<CgRoute>(kernels, *part_, *fields_);
  } else if (kernels.single()) {
    route_ = std::make_unique<HostCorrectedRoute>(kernels, *damaged_, *fields_, intact_,
                                                  setup.inverse.panel_bytes, setup.needs.damage);
  } else {
    route_ = std::make_unique<InverseRoute>(kernels, *damaged_, *fields_, intact_, setup.inverse,
                                            setup.needs.damage);
  }
}

std::vector<BufferPlan> DeviceBody::buffers() const {
  std::vector<BufferPlan> plan = route_->buffers();
  if (region_) {
    plan.front().name = "condensed " + plan.front().name;
    plan.push_back({"factor of the rest and its stiffness on the region (host)",
                    region_->bytes() + whole_u_.size() * sizeof(double)});
  }
  for (BufferPlan& b : fields_->buffers()) plan.push_back(std::move(b));
  return plan;
}

void DeviceBody::destroy(std::span<const Index> elements) {
  damaged_->destroy(elements);
  fields_->destroy(elements);
  route_->destroy(elements);
}

std::span<const Index> DeviceBody::on_device(std::span<const Index> elements) {
  if (!region_) return elements;
  in_part_.clear();
  for (Index e : elements) {
    if (region_->element(e) != kNone) in_part_.push_back(region_->element(e));
  }
  return in_part_;
}

Index DeviceBody::of_whole(std::uint32_t on_device) const {
  const auto e = static_cast<Index>(on_device);
  return region_ ? region_->region().elements[e] : e;
}

Load DeviceBody::load(const Load& of_whole) { return region_ ? region_->load(of_whole) : of_whole; }

void DeviceBody::solved(const Load& of_whole) {
  whole_u_known_ = false;
  if (region_) solved_load_ = of_whole;
}

void DeviceBody::show(std::span<const double> displacement) {
  std::vector<double> of_part(part_->dofs().size());
  for (Index n = 0; n < whole_.node_count(); ++n) {
    if (region_->node(n) == kNone) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      of_part[3 * static_cast<std::size_t>(region_->node(n)) + axis] =
          displacement[3 * static_cast<std::size_t>(n) + axis];
    }
  }
  fields_->write_displacement(of_part);
  vulkan::Commands commands(kernels_.device());
  commands.begin();
  fields_->record_state(commands, false);
  commands.end();
  commands.submit();
  whole_u_.assign(displacement.begin(), displacement.end());
  whole_u_known_ = true;
}

std::span<const double> DeviceBody::whole_displacement() const {
  if (whole_u_known_) return whole_u_;
  std::vector<double> of_part(part_->dofs().size());
  fields_->read_displacement(of_part);
  whole_u_.resize(whole_.dofs().size());
  region_->expand(solved_load_, of_part, whole_u_);
  whole_u_known_ = true;
  return whole_u_;
}

void DeviceBody::read_displacement(std::span<double> displacement) const {
  if (!region_) {
    fields_->read_displacement(displacement);
    return;
  }
  const auto whole = whole_displacement();
  std::copy(whole.begin(), whole.end(), displacement.begin());
}

void DeviceBody::read_displacement(std::span<const Index> nodes,
                                   std::span<Vec3> displacement) const {
  if (!region_) {
    read_nodes(nodes, displacement);
    return;
  }
  std::vector<Index> of_part;
  for (Index n : nodes) {
    if (region_->node(n) != kNone) of_part.push_back(region_->node(n));
  }
  if (of_part.size() == nodes.size()) {
    read_nodes(of_part, displacement);
    return;
  }
  const auto whole = whole_displacement();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    displacement[i] = Vec3(&whole[3 * static_cast<std::size_t>(nodes[i])]);
  }
}

void DeviceBody::read_nodes(std::span<const Index> nodes, std::span<Vec3> displacement) const {
  if (nodes.size() > kFewNodes) {
    fields_->read_displacement(nodes, displacement);
    return;
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    displacement[i] = fields_->read_displacement(nodes[i]);
  }
}

void DeviceBody::read_stress(std::span<Voigt> stress) const {
  if (!region_) {
    fields_->read_stress(stress);
    return;
  }
  std::vector<Voigt> of_part(part_->mesh().tets.size());
  fields_->read_stress(of_part);
  for (std::size_t e = 0; e < of_part.size(); ++e) {
    stress[region_->region().elements[e]] = of_part[e];
  }
  region_->stress_outside(whole_displacement(), stress);
}

Voigt DeviceBody::read_stress(Index element) const {
  const Index e = region_ ? region_->element(element) : element;
  if (e != kNone) return fields_->read_stress(e);
  return fem::stress(whole_.shape(element), whole_.small_strain(element),
                     fem::corner_displacement(whole_.mesh(), element, whole_displacement()));
}

double DeviceBody::largest_outside(Field field, const Load& of_whole) const {
  std::vector<double> of_part(part_->dofs().size()), whole(whole_.dofs().size());
  fields_->read(field, of_part);
  region_->expand(of_whole, of_part, whole);
  return region_->largest_outside(whole);
}

void DeviceBody::solve_pristine(const Load& of_whole, std::span<double> displacement) const {
  const Load load = region_ ? region_->load(of_whole) : of_whole;
  Eigen::VectorXd u;
  pristine_->solve({load.force_dofs, load.forces}, load.displacements, u);
  const std::span<const double> unknowns(u.data(), static_cast<std::size_t>(u.size()));
  if (!region_) {
    fem::scatter(whole_, unknowns, displacement);
    return;
  }
  std::vector<double> of_part(part_->dofs().size());
  fem::scatter(*part_, unknowns, of_part);
  region_->expand(of_whole, of_part, displacement);
}

}  // namespace sunder::gpu
