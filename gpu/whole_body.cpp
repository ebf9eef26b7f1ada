// SPDX-License-Identifier: Apache-2.0
#include "gpu/whole_body.hpp"

#include "body/assembly.hpp"
#include "gpu/cg_route.hpp"
#include "gpu/host_corrected_route.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

// Read back node by node up to here where the host maps the memory, gathered on the device beyond.
constexpr std::size_t kFewNodes = 64;

Fields::RouteNeeds route_needs(const DeviceSetup& setup, const Problem& problem) {
  const KernelFactory& kernels = setup.kernels;
  if (setup.plan.route == Route::cg) {
    return {.bytes = CgRoute::planned_bytes(kernels, problem), .preconditioner = true};
  }
  if (kernels.single()) {
    return {.bytes = HostCorrectedRoute::planned_bytes(kernels, problem, setup.inverse.panel_bytes),
            .along = true};
  }
  return {.bytes = InverseRoute::planned_bytes(kernels, problem, setup.inverse),
          .along = !setup.inverse.eager};
}

}  // namespace

WholeBody::WholeBody(const DeviceSetup& setup, std::future<IntactInverse> started)
    : problem_(setup.body.problem()),
      damaged_(setup.body),
      fields_(setup.kernels, problem_, setup.needs, route_needs(setup, problem_)),
      force_(fields_.rows(), 0.0),
      mapped_(setup.kernels.device().physical().unified()) {
  const bool cg = setup.plan.route == Route::cg, pristine = setup.needs.pristine;
  IntactInverse intact;
  if (!cg || pristine) {
    intact = started.valid()
                 ? started.get()
                 : std::make_shared<const HostInverse>(problem_, !cg && !setup.inverse.on_device);
  }
  if (pristine) pristine_ = intact_update(problem_, intact);
  make_route(setup, std::move(intact));
  frame_.emplace(damaged_, fields_, *route_, setup.plan.fp64);
}

void WholeBody::make_route(const DeviceSetup& setup, IntactInverse intact) {
  const KernelFactory& kernels = setup.kernels;
  const bool damage = setup.needs.damage;
  if (setup.plan.route == Route::cg) {
    route_ = std::make_unique<CgRoute>(kernels, damaged_, fields_);
  } else if (kernels.single()) {
    route_ = std::make_unique<HostCorrectedRoute>(kernels, damaged_, fields_, std::move(intact),
                                                  setup.inverse.panel_bytes, damage);
  } else {
    route_ = std::make_unique<InverseRoute>(kernels, damaged_, fields_, std::move(intact),
                                            setup.inverse, damage);
  }
}

void WholeBody::set_load(const Load& load) {
  for (Index d : loaded_) force_[d] = 0;
  loaded_ = load.force_dofs;
  for (std::size_t i = 0; i < load.forces.size(); ++i) force_[loaded_[i]] = load.forces[i];
  fields_.set_load(force_, load.displacements);
  frame_->set_load(load);
}

void WholeBody::destroy(std::span<const Index> elements) {
  fields_.destroy(elements, damaged_.scale(), damaged_.forms().pools());
  route_->destroy(elements);
}

void WholeBody::grip(const fem::Event& event, std::span<const Index>) {
  fields_.grip(damaged_.forms().gripped(), damaged_.scale());
  route_->grip(event);
  if (pristine_ && !pristine_->follow(event)) {
    throw NumericalError("the compliance of the gripped nodes is singular in double precision");
  }
}

void WholeBody::read_displacement(std::span<const Index> nodes,
                                  std::span<Vec3> displacement) const {
  if (nodes.size() > (mapped_ ? kFewNodes : 1)) {
    fields_.read_displacement(nodes, displacement);
    return;
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    displacement[i] = fields_.read_displacement(nodes[i]);
  }
}

void WholeBody::solve_pristine(const Load& load, std::span<double> displacement) {
  Eigen::VectorXd u;
  pristine_->solve({load.force_dofs, load.forces}, load.displacements, u);
  fem::scatter(problem_, {u.data(), static_cast<std::size_t>(u.size())}, displacement);
}

std::vector<BufferPlan> WholeBody::buffers() const {
  std::vector<BufferPlan> plan = route_->buffers();
  for (BufferPlan& b : fields_.buffers()) plan.push_back(std::move(b));
  return plan;
}

}  // namespace sunder::gpu
