// SPDX-License-Identifier: Apache-2.0
#include "gpu/condensed_body.hpp"

#include <algorithm>

#include "body/assembly.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {

namespace {

/// Whole where there is room for that beside the fields and the host's own does not lie in the same
/// memory (a processor is asked by name); else columns of it. Null where the device is not to
/// multiply, would never come to so many columns, or has no memory left for them: the host does it
/// then.
std::unique_ptr<RegionInverse> make_inverse(const DeviceSetup& setup,
                                            const solver::Region& region) {
  using Extent = RegionInverse::Extent;
  const auto& least = setup.inverse.region;
  const std::size_t panel = setup.inverse.panel_bytes;
  const auto unknowns = static_cast<Index>(region.dofs.size());
  if (!least || RegionInverse::most_values(unknowns) < *least) return nullptr;
  const auto made = [&](Extent extent, double free, const char* instead) {
    return where_room<RegionInverse>(
        setup.kernels.device(), free,
        [&] { return RegionInverse::planned_bytes(setup.kernels, unknowns, panel, extent); },
        instead, setup.inverse.leave_out, setup.kernels, unknowns, panel, *least, extent);
  };
  constexpr double kFree = .1;  // for what others bring
  const vulkan::PhysicalDevice& device = setup.kernels.device().physical();
  if (!device.unified() || device.is_cpu()) {
    auto whole = made(Extent::whole, kFree,
                      "the region's whole inverse on the device, which has no memory left for it: "
                      "columns come with the frames that need them");
    if (whole) return whole;
  }
  return made(Extent::columns, 0,
              "columns of the region on the device, which has no memory left for them: the host "
              "multiplies");
}

}  // namespace

CondensedBody::CondensedBody(const DeviceSetup& setup, const solver::Region& region)
    : problem_(setup.body.problem()),
      damaged_(setup.body),
      part_(problem_, region),
      fields_(setup.kernels, *part_.problem(), setup.needs, {.residual = false}),
      commands_(setup.kernels.device()),
      intact_(std::make_shared<const HostInverse>(problem_, false)),
      inverse_(make_inverse(setup, region)),
      damage_(DamageSolution::make(setup.kernels, solver::columns_of_a_base(region.dofs.size()),
                                   problem_.gripped_dofs().size(), setup.inverse.damage,
                                   setup.inverse.leave_out)),
      route_(solver::condensed_route(damaged_, {intact_, &intact_->factor()}, region.dofs,
                                     setup.needs.damage, {}, inverse_.get(), damage_.get())),
      frame_(damaged_, *route_, *this),
      outside_(damaged_, region),
      nodal_(part_.problem()->dofs().size(), 0.0),
      next_nodal_(nodal_),
      whole_nodal_(problem_.dofs().size(), 0.0) {
  if (setup.needs.pristine) pristine_ = intact_update(problem_, intact_);
}

std::span<const Index> CondensedBody::on_device(std::span<const Index> elements) {
  in_part_.clear();
  for (Index e : elements) {
    if (part_.element(e) != kNone) in_part_.push_back(part_.element(e));
  }
  return in_part_;
}

std::optional<double> CondensedBody::take(const Eigen::VectorXd& u) {
  for (std::size_t i = 0; i < part_.nodes().size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem_.dof(part_.nodes()[i], axis);
      if (d != kNone) next_nodal_[3 * i + static_cast<std::size_t>(axis)] = u[d];
    }
  }
  fields_.write_displacement(next_nodal_);
  show();
  return fields_.largest_stress(Field::displacement);
}

/// Stress and summary of the displacement that is there.
void CondensedBody::show() {
  commands_.begin();
  fields_.record_state(commands_, false);
  commands_.end();
  commands_.submit();
}

void CondensedBody::restore() {
  fields_.write_displacement(nodal_);
  show();
}

void CondensedBody::publish(bool everywhere) {
  nodal_.swap(next_nodal_);
  whole_known_ = false;
  if (!everywhere) {
    outside_.take(*route_);
    return;
  }
  const Eigen::VectorXd& u = frame_.u();
  fem::scatter(problem_, {u.data(), static_cast<std::size_t>(u.size())}, whole_nodal_);
  outside_.take(whole_nodal_);
  whole_known_ = true;
}

void CondensedBody::destroy(std::span<const Index> elements) {
  fields_.destroy(on_device(elements), {});  // it has no stiffness of its own
  route_->follow({.leave = elements});
}

void CondensedBody::grip(const fem::Event& event, std::span<const Index> before) {
  frame_.follow_grips(before);
  route_->follow(event);
  if (pristine_ && !pristine_->follow(event)) {
    throw NumericalError("the compliance of the gripped nodes is singular in double precision");
  }
}

void CondensedBody::read_displacement(std::span<double> displacement) const {
  if (!whole_known_) {
    for (std::size_t i = 0; i < part_.nodes().size(); ++i) {
      std::copy_n(&nodal_[3 * i], 3, &whole_nodal_[3 * static_cast<std::size_t>(part_.nodes()[i])]);
    }
    outside_.complete(whole_nodal_);
    whole_known_ = true;
  }
  std::copy(whole_nodal_.begin(), whole_nodal_.end(), displacement.begin());
}

void CondensedBody::read_displacement(std::span<const Index> nodes,
                                      std::span<Vec3> displacement) const {
  const bool inside = std::ranges::all_of(
      nodes, [this](Index n) { return outside_.region().inside[n] && part_.node(n) != kNone; });
  std::vector<double> whole;
  if (!inside) {
    whole.resize(whole_nodal_.size());
    read_displacement(whole);
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    displacement[i] = inside ? Vec3(&nodal_[3 * static_cast<std::size_t>(part_.node(nodes[i]))])
                             : Vec3(&whole[3 * static_cast<std::size_t>(nodes[i])]);
  }
}

void CondensedBody::read_stress(std::span<Voigt> stress) const {
  const auto whole = outside_.stress();
  std::copy(whole.begin(), whole.end(), stress.begin());
  std::vector<Voigt> of_part(part_.elements().size());
  fields_.read_stress(of_part);
  for (std::size_t i = 0; i < of_part.size(); ++i) stress[part_.elements()[i]] = of_part[i];
}

Voigt CondensedBody::read_stress(Index element) const {
  const Index e = part_.element(element);
  return e != kNone ? fields_.read_stress(e) : outside_.stress()[element];
}

void CondensedBody::read_reactions(std::span<double> reactions) const {
  std::ranges::copy(frame_.reactions(), reactions.begin());
}

void CondensedBody::solve_pristine(const Load& load, std::span<double> displacement) {
  Eigen::VectorXd u;
  pristine_->solve({load.force_dofs, load.forces}, load.displacements, u);
  fem::scatter(problem_, {u.data(), static_cast<std::size_t>(u.size())}, displacement);
}

std::vector<BufferPlan> CondensedBody::buffers() const {
  std::vector<BufferPlan> plan = route_->buffers();
  plan.push_back({"intact factor (host)", intact_->bytes()});
  plan.push_back({"fields outside the condensed region (host)",
                  outside_.bytes() + whole_nodal_.size() * sizeof(double)});
  if (inverse_) {
    plan.push_back({inverse_->extent() == RegionInverse::Extent::whole
                        ? "inverse of the region (device)"
                        : "columns of the region (device)",
                    inverse_->bytes()});
  }
  if (damage_) plan.push_back({"small matrices of the damage (device)", damage_->bytes()});
  for (BufferPlan& b : fields_.buffers()) plan.push_back(std::move(b));
  return plan;
}

}  // namespace sunder::gpu
