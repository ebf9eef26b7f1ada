// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan_backend.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <future>

#include "engine/instrument_block.hpp"
#include "engine/substructure.hpp"
#include "fem/element.hpp"
#include "gpu/cg_route.hpp"
#include "gpu/choose_device.hpp"
#include "gpu/cost_model.hpp"
#include "gpu/frame_check.hpp"
#include "gpu/host_corrected_route.hpp"
#include "gpu/inverse_route.hpp"
#include "gpu/plan.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

constexpr int kRefinements = 6;
// Read back node by node up to here, gathered on the device beyond.
constexpr std::size_t kFewNodes = 64;

std::unique_ptr<vulkan::Device> open_device(const VulkanOptions& options, int asked) {
  if (options.lent) return vulkan::borrow_device(*options.lent, options.probe);
  const auto instance = std::make_shared<vulkan::Instance>(options.instance);
  vulkan::PhysicalDevice physical = choose_device(*instance, asked);
  physical.float64 = physical.float64 && !options.probe.no_float64;
  return vulkan::create_device(instance, physical, options.probe);
}

using IntactInverse = std::shared_ptr<const HostInverse>;

IntactInverse invert(const Problem& problem, bool keep_dense) {
  return std::make_shared<const HostInverse>(problem, std::span<const double>{}, keep_dense);
}

/// On a thread of its own, while loader, device and pipelines are made ready.
std::future<IntactInverse> start_inverse(const Problem& problem, const VulkanOptions& options) {
  if (options.invert_on_device.value_or(false) || !host_inverts_anyway(problem)) return {};
  return std::async(std::launch::async, [&problem] { return invert(problem, true); });
}

class VulkanBackend final : public Backend {
 public:
  VulkanBackend(std::shared_ptr<const Problem> problem, Needs needs, const VulkanOptions& options)
      : Backend(problem, std::move(needs)),
        started_(start_inverse(*problem, options)),
        device_(open_device(options, problem->scene().solver.device)),
        plan_(make_plan(*problem, this->needs(), device_->physical(), options.lent.has_value())),
        kernels_(*device_, options.variant.value_or(choose_variant(device_->physical())),
                 plan_.fp64),
        inverse_{plan_.eager, problem->scene().solver.tolerance, options.panel_bytes,
                 options.invert_on_device.value_or(plan_.invert_on_device)},
        region_(plan_.region ? std::make_unique<engine::Substructure>(*problem, *plan_.region)
                             : nullptr),
        body_(region_ ? region_->part() : problem),
        fields_(kernels_, *body_, this->needs(), route_needs()),
        check_(*problem, plan_.fp64) {
    if (!plan_.cg || this->needs().pristine) {
      intact_ = started_.valid() && !region_ ? started_.get()
                                             : invert(*body_, !plan_.cg && !inverse_.on_device);
    }
    if (this->needs().pristine) {
      pristine_ = std::make_unique<Correction>(
          *body_, [host = intact_](std::span<const Index> dofs) { return host->columns(dofs); });
    }
    force_.assign(fields_.rows(), 0.0);
    if (region_) leave_out_the_rest();
    device_->set_timing(false);
    if (options.lent) {
      display_ = std::make_unique<Display>(kernels_, *problem, fields_, this->needs().stress,
                                           options.display, options.lent->timeline_semaphore);
    }
    if (plan_.cg) {
      route_ = std::make_unique<CgRoute>(kernels_, *body_, fields_);
      return;
    }
    if (kernels_.single()) {
      route_ = std::make_unique<HostCorrectedRoute>(kernels_, *body_, fields_, intact_,
                                                    inverse_.panel_bytes);
      return;
    }
    route_ = std::make_unique<InverseRoute>(kernels_, *body_, fields_, intact_, inverse_);
  }

  BackendInfo info() const override {
    BackendInfo info;
    info.backend = "vulkan";
    info.device = device_->physical().name;
    info.driver = device_->physical().driver;
    info.precision = plan_.fp64 ? "fp64" : "fp32";
    info.route = region_ ? "condensed" : route_->name();
    info.update = needs().damage ? route_->update() : "none";
    info.why = plan_.why;
    for (const BufferPlan& b : buffers()) info.memory_bytes += b.bytes;
    const FrameCost cost = frame_cost(shape(), device_->physical());
    info.quiet_ms = cost.quiet_ms;
    info.fracture_ms = cost.fracture_ms;
    return info;
  }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = route_->buffers();
    if (region_) {
      plan.front().name = "condensed " + plan.front().name;
      plan.push_back({"factor of the rest and its stiffness on the region (host)",
                      region_->bytes() + whole_u_.size() * sizeof(double)});
    }
    for (BufferPlan& b : fields_.buffers()) plan.push_back(std::move(b));
    return plan;
  }

  std::shared_ptr<InstrumentForces> instrument_forces() override {
    if (!instruments_ && !body_->gripped_dofs().empty() && route_->grip_factor()) {
      instruments_.emplace(*body_);
      if (solved_) publish_instruments();
    }
    return instruments_ ? instruments_->forces() : nullptr;
  }
  void take_over_instrument_forces(std::shared_ptr<InstrumentForces> forces) override {
    if (instrument_forces()) instruments_->take_over(std::move(forces));
  }

  void time_passes(bool on) override { device_->set_timing(on); }
  std::vector<PassTime> take_pass_times() override {
    std::vector<PassTime> times;
    for (const vulkan::PassTime& t : device_->take_times()) {
      times.push_back({t.pass, t.milliseconds});
    }
    return times;
  }

  DeviceUse device_use() const {
    return {device_->held_bytes(), device_->most_bytes(), device_->queue().submits(),
            device_->pipelines()};
  }
  std::vector<Index> over_yield() const {
    std::vector<Index> list = fields_.over_yield();
    for (Index& e : list) e = of_body(static_cast<std::uint32_t>(e));
    return list;
  }
  std::size_t bytes_read() const { return device_->bytes_read(); }
  const std::vector<std::string>& warnings() const { return plan_.warnings; }
  Display* display() { return display_.get(); }

 private:
  [[nodiscard]] FrameShape shape() const {
    FrameShape shape;
    shape.cg = plan_.cg;
    shape.eager = plan_.eager;
    shape.host_corrects = kernels_.single();
    shape.damage = needs().damage;
    shape.real_bytes = kernels_.real_bytes();
    shape.rows = fields_.rows();
    shape.grips = body_->gripped_dofs().size();
    for (const InstrumentNodes& i : problem().instrument_nodes()) {
      shape.loaded += 3 * std::max<std::size_t>(i.nodes.size(), 2);  // 2: a press
    }
    shape.loaded -= std::min(shape.loaded, shape.grips);
    shape.elements = body_->mesh().tets.size();
    shape.stiffness_bytes = fields_.matrix().bytes();
    shape.stress = needs().stress;
    return shape;
  }

  /// What a host's submit still reads must not be written.
  void finish_display() {
    if (display_) display_->finish();
  }

  [[nodiscard]] Fields::RouteNeeds route_needs() const {
    if (plan_.cg) return {CgRoute::planned_bytes(*body_), true};
    if (kernels_.single()) {
      return {HostCorrectedRoute::planned_bytes(kernels_, *body_, inverse_.panel_bytes), false};
    }
    return {InverseRoute::planned_bytes(kernels_, *body_, inverse_), false};
  }

  void leave_out_the_rest() {
    for (std::string& what : engine::left_out_of(problem(), region_->region())) {
      leave_out(std::move(what));
    }
  }

  void do_set_load(const Load& load) override {
    finish_display();
    for (Index d : load_.force_dofs) force_[d] = 0;
    if (region_) whole_load_ = load;
    load_ = region_ ? region_->load(load) : load;
    solved_ = false;
    force_squared_ = 0;
    for (double f : load.forces) force_squared_ += f * f;
    for (std::size_t i = 0; i < load_.forces.size(); ++i) {
      force_[load_.force_dofs[i]] = load_.forces[i];
    }
    fields_.set_load(force_, load_.displacements);
  }

  /// Elements as the device numbers them.
  std::span<const Index> on_device(std::span<const Index> elements) {
    if (!region_) return elements;
    in_part_.clear();
    for (Index e : elements) {
      if (region_->element(e) != kNone) in_part_.push_back(region_->element(e));
    }
    return in_part_;
  }
  [[nodiscard]] Index of_body(std::uint32_t on_device) const {
    const auto e = static_cast<Index>(on_device);
    return region_ ? region_->region().elements[e] : e;
  }

  SolveReport do_solve() override {
    finish_display();
    if (!check_.known(load_)) fields_.keep_next();
    try {
      const SolveReport report = solve_within_tolerance();
      solved_load_ = whole_load_;
      whole_u_known_ = false;
      solved_ = true;
      if (instruments_) publish_instruments();
      return report;
    } catch (const NumericalError&) {
      check_.event();
      fields_.restore();  // results so far stay readable
      throw;
    }
  }

  /// Only once somebody has asked for them: the reactions are read back from the device.
  void publish_instruments() {
    reactions_.resize(body_->gripped_dofs().size());
    fields_.read_reactions(body_->gripped_dofs(), reactions_);
    instruments_->publish(*route_->grip_factor(), reactions_, load_.displacements);
  }

  SolveReport solve_within_tolerance() {
    SolveReport report;
    do {
      report = attempt();
    } while (!(report.error <= tolerance()) && route_->restart(destroyed_list_));
    if (!(report.error <= tolerance())) {
      throw NumericalError(
          "the solution cannot be brought under the tolerance: estimated stress error " +
          std::to_string(report.error) + ", residual " + std::to_string(report.residual) +
          "; use precision fp64, raise solver.tolerance or ease contrast, Poisson's ratio or "
          "slivers");
    }
    return report;
  }

  /// One solve, refined while that helps and is needed.
  SolveReport attempt() {
    SolveReport report;
    const double target = check_.target();
    if (const auto known = check_.known(load_)) {
      report = *known;
      report.iterations = route_->solve(load_, !body_->gripped_dofs().empty());
      if (std::isfinite(fields_.state().stress_squared)) return report;
    }
    check_.event();
    report.iterations += route_->solve(load_, true);
    const auto energy = route_->energy_bound();
    const double stress = std::sqrt(fields_.state().stress_squared);
    if (energy) {
      if (const auto error = check_.bounded(load_, *energy, stress, route_->bases())) {
        report.error = *error;
        report.residual = residual();
        check_.checked(load_, report);
        return report;
      }
    }
    for (int refinement = 0;; ++refinement) {
      report.iterations += route_->correct();
      const double error = estimate();
      report.residual = residual();
      if (refinement == 0) {
        report.polished = !(error <= tolerance());
        if (route_->leaves_at(error, destroyed_list_)) return attempt();
      }
      // A correction that no longer shrinks is rounding: stop there if the promise holds.
      const bool stalled = refinement > 0 && !(error < report.error / 2);
      report.error = error;
      if (refinement == 0 && energy) {
        check_.estimated(load_, error, *energy, stress, route_->bases());
      }
      if (refinement == 0 && error <= target) check_.checked(load_, report);
      if (error <= target || refinement == kRefinements || stalled) return report;
      route_->add_correction();
    }
  }

  double estimate() const {
    double of_u = std::sqrt(fields_.state().stress_squared);
    double of_du = std::sqrt(fields_.correction().stress_squared);
    if (!std::isfinite(residual())) return residual();
    if (!std::isfinite(of_u)) return of_u;
    if (region_) {
      of_u = std::max(of_u, largest_outside(Field::displacement, whole_load_));
      of_du = std::max(of_du, largest_outside(Field::correction, {}));
    }
    return of_du == 0 ? 0.0 : of_du / of_u;
  }

  /// Stress of a field outside the region: the rest may be stiffer and feel what the region does
  /// not.
  double largest_outside(Field field, const Load& load) const {
    std::vector<double> of_part(body_->dofs().size()), whole(problem().dofs().size());
    fields_.read(field, of_part);
    region_->expand(load, of_part, whole);
    return region_->largest_outside(whole);
  }

  double residual() const {
    const shaders::Summary s = fields_.state();
    const double load = force_squared_ + s.reaction_squared;
    return load > 0 ? std::sqrt(s.residual_squared / load) : 0.0;
  }

  double tolerance() const { return problem().scene().solver.tolerance; }

  StressSummary do_stress() override {
    if (!needs().yield) return {};
    const shaders::Summary s = fields_.state();
    const auto worst = [this](double ratio, std::uint32_t element) {
      return ratio > 0 ? Worst{of_body(element), ratio} : Worst{};
    };
    return {worst(s.any_ratio, s.any_element), worst(s.candidate_ratio, s.candidate_element),
            static_cast<Index>(s.over)};
  }

  void do_destroy(std::span<const Index> elements) override {
    require_in_region(elements);
    finish_display();
    check_.event();
    solved_ = false;
    const auto list = on_device(elements);
    destroyed_list_.insert(destroyed_list_.end(), list.begin(), list.end());
    fields_.destroy(list);
    route_->destroy(list, destroyed_list_);
  }

  /// What the scene says can be destroyed is in the region.
  void require_in_region(std::span<const Index> elements) const {
    if (!region_) return;
    for (Index e : elements) {
      if (region_->element(e) != kNone) continue;
      throw UsageError(
          "element " + std::to_string(e) +
          " cannot be destroyed by route condensed on vulkan: it lies outside what the "
          "scene lets break, tears or scripts; use route inverse or cg");
    }
  }

  void do_exclude_candidates(std::span<const Index> elements) override {
    finish_display();
    fields_.exclude(on_device(elements));  // outside the region nothing is a candidate
  }

  void do_solve_pristine(const Load& of_problem, std::span<double> displacement) override {
    const Load load = region_ ? region_->load(of_problem) : of_problem;
    const Loaded loaded{load.force_dofs, load.forces};
    Eigen::VectorXd u = Eigen::VectorXd::Zero(body_->dof_count());
    const Eigen::MatrixXd columns = intact_->columns(load.force_dofs);
    for (std::size_t i = 0; i < load.forces.size(); ++i) {
      u += load.forces[i] * columns.col(static_cast<Index>(i));
    }
    if (pristine_->count() > 0) {
      u += pristine_->columns() *
           pristine_->coefficients(pristine_->project(loaded), load.displacements);
    }
    const std::span<const double> unknowns(u.data(), static_cast<std::size_t>(u.size()));
    if (!region_) {
      fem::scatter(problem(), unknowns, displacement);
      return;
    }
    std::vector<double> of_part(body_->dofs().size());
    fem::scatter(*body_, unknowns, of_part);
    region_->expand(of_problem, of_part, displacement);
  }

  /// Displacement of the last solution at all nodes of the problem: outside a region it is solved
  /// for, once a solution.
  std::span<const double> whole_displacement() const {
    if (whole_u_known_) return whole_u_;
    std::vector<double> of_part(body_->dofs().size());
    fields_.read_displacement(of_part);
    whole_u_.resize(problem().dofs().size());
    region_->expand(solved_load_, of_part, whole_u_);
    whole_u_known_ = true;
    return whole_u_;
  }

  void do_read_displacement(std::span<double> displacement) const override {
    if (!region_) {
      fields_.read_displacement(displacement);
      return;
    }
    const auto whole = whole_displacement();
    std::copy(whole.begin(), whole.end(), displacement.begin());
  }

  void do_read_displacement(std::span<const Index> nodes,
                            std::span<Vec3> displacement) const override {
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

  void read_nodes(std::span<const Index> nodes, std::span<Vec3> displacement) const {
    if (nodes.size() > kFewNodes) {
      fields_.read_displacement(nodes, displacement);
      return;
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      displacement[i] = fields_.read_displacement(nodes[i]);
    }
  }

  void do_read_stress(std::span<Voigt> stress) const override {
    if (!region_) {
      fields_.read_stress(stress);
      return;
    }
    std::vector<Voigt> of_part(body_->mesh().tets.size());
    fields_.read_stress(of_part);
    for (std::size_t e = 0; e < of_part.size(); ++e) {
      stress[region_->region().elements[e]] = of_part[e];
    }
    region_->stress_outside(whole_displacement(), stress);
  }

  Voigt do_read_stress(Index element) const override {
    const Index e = region_ ? region_->element(element) : element;
    if (e != kNone) return fields_.read_stress(e);
    return fem::stress(problem().shape(element), problem().material(element),
                       fem::corner_displacement(problem().mesh(), element, whole_displacement()));
  }

  void do_read_reactions(std::span<double> reactions) const override {
    fields_.read_reactions(body_->gripped_dofs(), reactions);
  }

  std::future<IntactInverse> started_;
  std::unique_ptr<vulkan::Device> device_;
  Plan plan_;
  KernelFactory kernels_;
  InverseOptions inverse_;  // of routes inverse and condensed
  std::unique_ptr<engine::Substructure>
      region_;                           // route condensed; null: the whole is on the device
  std::shared_ptr<const Problem> body_;  // what the device has
  Fields fields_;
  FrameCheck check_;
  IntactInverse intact_;
  std::unique_ptr<Correction> pristine_;  // of the intact body: its grips
  std::unique_ptr<Display> display_;
  std::unique_ptr<DeviceRoute> route_;
  Load load_;  // of body_
  // Of a region's problem: the load set, that of the last solution, and its displacement once read.
  Load whole_load_, solved_load_;
  mutable std::vector<double> whole_u_;
  mutable bool whole_u_known_ = false;
  std::vector<Index> in_part_;
  std::optional<engine::InstrumentBlock> instruments_;  // once asked for
  std::vector<double> reactions_;
  bool solved_ = false;        // the load and the damage as they are
  std::vector<double> force_;  // over the padded unknowns
  double force_squared_ = 0;
  std::vector<Index> destroyed_list_;
};

}  // namespace

VulkanOptions options_from_environment() {
  VulkanOptions options;
  const char* validation = std::getenv("SUNDER_VULKAN_VALIDATION");
  options.instance.validation = validation && std::strcmp(validation, "1") == 0;
  const char* no_float64 = std::getenv("SUNDER_VULKAN_NO_FLOAT64");
  options.probe.no_float64 = no_float64 && std::strcmp(no_float64, "1") == 0;
  return options;
}

std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs) {
  return create(std::move(problem), std::move(needs), options_from_environment());
}

std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs,
                                const VulkanOptions& options) {
  if (!problem) throw UsageError("a backend needs a problem");
  return std::make_unique<VulkanBackend>(std::move(problem), std::move(needs), options);
}

Display* display_of(Backend& backend) {
  auto* of_vulkan = dynamic_cast<VulkanBackend*>(&backend);
  return of_vulkan ? of_vulkan->display() : nullptr;
}

DeviceUse device_use(const Backend& backend) {
  const auto* vulkan_backend = dynamic_cast<const VulkanBackend*>(&backend);
  return vulkan_backend ? vulkan_backend->device_use() : DeviceUse{};
}

std::vector<Index> over_yield(const Backend& backend) {
  const auto* vulkan_backend = dynamic_cast<const VulkanBackend*>(&backend);
  return vulkan_backend ? vulkan_backend->over_yield() : std::vector<Index>{};
}

std::size_t bytes_read(const Backend& backend) {
  const auto* vulkan_backend = dynamic_cast<const VulkanBackend*>(&backend);
  return vulkan_backend ? vulkan_backend->bytes_read() : 0;
}

std::vector<std::string> warnings(const Backend& backend) {
  const auto* vulkan_backend = dynamic_cast<const VulkanBackend*>(&backend);
  return vulkan_backend ? vulkan_backend->warnings() : std::vector<std::string>{};
}

}  // namespace sunder::gpu
