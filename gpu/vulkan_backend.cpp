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
        check_(*problem, plan_.fp64) {
    device_->set_timing(false);
    on_.body = std::move(problem);
    put_on_device(plan_.region);
    if (on_.region) leave_out_the_rest();
    if (options.lent) {
      display_ =
          std::make_unique<Display>(kernels_, this->problem(), *on_.fields, this->needs().stress,
                                    options.display, options.lent->timeline_semaphore);
    }
  }

  BackendInfo info() const override {
    BackendInfo info;
    info.backend = "vulkan";
    info.device = device_->physical().name;
    info.driver = device_->physical().driver;
    info.precision = plan_.fp64 ? "fp64" : "fp32";
    info.route = on_.region ? "condensed" : on_.route->name();
    info.update = needs().damage ? on_.route->update() : "none";
    info.why = plan_.why;
    for (const BufferPlan& b : buffers()) info.memory_bytes += b.bytes;
    const FrameCost cost = frame_cost(shape(), device_->physical());
    info.quiet_ms = cost.quiet_ms;
    info.fracture_ms = cost.fracture_ms;
    return info;
  }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = on_.route->buffers();
    if (on_.region) {
      plan.front().name = "condensed " + plan.front().name;
      plan.push_back({"factor of the rest and its stiffness on the region (host)",
                      on_.region->bytes() + whole_u_.size() * sizeof(double)});
    }
    for (BufferPlan& b : on_.fields->buffers()) plan.push_back(std::move(b));
    return plan;
  }

  std::shared_ptr<InstrumentForces> instrument_forces() override {
    if (!instruments_ && !on_.body->gripped_dofs().empty() && on_.route->grip_factor()) {
      instruments_.emplace(*on_.body);
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
    std::vector<Index> list = on_.fields->over_yield();
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
    shape.rows = on_.fields->rows();
    shape.grips = on_.body->gripped_dofs().size();
    for (const InstrumentNodes& i : problem().instrument_nodes()) {
      shape.loaded += 3 * std::max<std::size_t>(i.nodes.size(), 2);  // 2: a press
    }
    shape.loaded -= std::min(shape.loaded, shape.grips);
    shape.elements = on_.body->mesh().tets.size();
    shape.stiffness_bytes = on_.fields->matrix().bytes();
    shape.stress = needs().stress;
    return shape;
  }

  void put_on_device(std::optional<engine::Region> region) {
    if (region) {
      on_.region = std::make_unique<engine::Substructure>(problem(), std::move(*region));
      on_.body = on_.region->part();
    }
    on_.fields = std::make_unique<Fields>(kernels_, *on_.body, needs(), route_needs());
    prepare_intact();
    on_.route = make_route();
  }

  void prepare_intact() {
    if (!plan_.cg || needs().pristine) {
      on_.intact = started_.valid() && !on_.region
                       ? started_.get()
                       : invert(*on_.body, !plan_.cg && !inverse_.on_device);
    }
    if (!needs().pristine) return;
    on_.pristine = std::make_unique<Correction>(
        *on_.body,
        [host = on_.intact](std::span<const Index> dofs) { return host->columns(dofs); });
  }

  [[nodiscard]] std::unique_ptr<DeviceRoute> make_route() {
    force_.assign(on_.fields->rows(), 0.0);
    if (plan_.cg) return std::make_unique<CgRoute>(kernels_, *on_.body, *on_.fields);
    if (kernels_.single()) {
      return std::make_unique<HostCorrectedRoute>(kernels_, *on_.body, *on_.fields, on_.intact,
                                                  inverse_.panel_bytes);
    }
    return std::make_unique<InverseRoute>(kernels_, *on_.body, *on_.fields, on_.intact, inverse_);
  }

  /// What a host's submit still reads must not be written.
  void finish_display() {
    if (display_) display_->finish();
  }

  [[nodiscard]] Fields::RouteNeeds route_needs() const {
    if (plan_.cg) return {CgRoute::planned_bytes(*on_.body), true};
    if (kernels_.single()) {
      return {HostCorrectedRoute::planned_bytes(kernels_, *on_.body, inverse_.panel_bytes), false};
    }
    return {InverseRoute::planned_bytes(kernels_, *on_.body, inverse_), false};
  }

  void leave_out_the_rest() {
    for (std::string& what : engine::left_out_of(problem(), on_.region->region())) {
      leave_out(std::move(what));
    }
  }

  void do_set_load(const Load& load) override {
    finish_display();
    for (Index d : load_.force_dofs) force_[d] = 0;
    if (on_.region) whole_load_ = load;
    load_ = on_.region ? on_.region->load(load) : load;
    solved_ = false;
    force_squared_ = 0;
    for (double f : load.forces) force_squared_ += f * f;
    for (std::size_t i = 0; i < load_.forces.size(); ++i) {
      force_[load_.force_dofs[i]] = load_.forces[i];
    }
    on_.fields->set_load(force_, load_.displacements);
  }

  /// Elements as the device numbers them.
  std::span<const Index> on_device(std::span<const Index> elements) {
    if (!on_.region) return elements;
    in_part_.clear();
    for (Index e : elements) {
      if (on_.region->element(e) != kNone) in_part_.push_back(on_.region->element(e));
    }
    return in_part_;
  }
  [[nodiscard]] Index of_body(std::uint32_t on_device) const {
    const auto e = static_cast<Index>(on_device);
    return on_.region ? on_.region->region().elements[e] : e;
  }

  SolveReport do_solve() override {
    finish_display();
    if (!check_.known(load_)) on_.fields->keep_next();
    try {
      const SolveReport report = solve_within_tolerance();
      solved_load_ = whole_load_;
      whole_u_known_ = false;
      solved_ = true;
      if (instruments_) publish_instruments();
      return report;
    } catch (const NumericalError&) {
      check_.event();
      on_.fields->restore();  // results so far stay readable
      throw;
    }
  }

  /// Only once somebody has asked for them: the reactions are read back from the device.
  void publish_instruments() {
    reactions_.resize(on_.body->gripped_dofs().size());
    on_.fields->read_reactions(on_.body->gripped_dofs(), reactions_);
    instruments_->publish(*on_.route->grip_factor(), reactions_, load_.displacements);
  }

  SolveReport solve_within_tolerance() {
    SolveReport report;
    do {
      report = attempt();
    } while (!(report.error <= tolerance()) && on_.route->restart(destroyed_list_));
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
      report.iterations = on_.route->solve(load_, !on_.body->gripped_dofs().empty());
      if (std::isfinite(on_.fields->state().stress_squared)) return report;
    }
    check_.event();
    report.iterations += on_.route->solve(load_, true);
    const auto energy = on_.route->energy_bound();
    const double stress = std::sqrt(on_.fields->state().stress_squared);
    if (energy) {
      if (const auto error = check_.bounded(load_, *energy, stress, on_.route->bases())) {
        report.error = *error;
        report.residual = residual();
        check_.checked(load_, report);
        return report;
      }
    }
    for (int refinement = 0;; ++refinement) {
      report.iterations += on_.route->correct();
      const double error = estimate();
      report.residual = residual();
      if (refinement == 0) {
        report.polished = !(error <= tolerance());
        if (on_.route->leaves_at(error, destroyed_list_)) return attempt();
      }
      // A correction that no longer shrinks is rounding: stop there if the promise holds.
      const bool stalled = refinement > 0 && !(error < report.error / 2);
      report.error = error;
      if (refinement == 0 && energy) {
        check_.estimated(load_, error, *energy, stress, on_.route->bases());
      }
      if (refinement == 0 && error <= target) check_.checked(load_, report);
      if (error <= target || refinement == kRefinements || stalled) return report;
      on_.route->add_correction();
    }
  }

  double estimate() const {
    double of_u = std::sqrt(on_.fields->state().stress_squared);
    double of_du = std::sqrt(on_.fields->correction().stress_squared);
    if (!std::isfinite(residual())) return residual();
    if (!std::isfinite(of_u)) return of_u;
    if (on_.region) {
      of_u = std::max(of_u, largest_outside(Field::displacement, whole_load_));
      of_du = std::max(of_du, largest_outside(Field::correction, {}));
    }
    return of_du == 0 ? 0.0 : of_du / of_u;
  }

  /// Stress of a field outside the region: the rest may be stiffer and feel what the region does
  /// not.
  double largest_outside(Field field, const Load& load) const {
    std::vector<double> of_part(on_.body->dofs().size()), whole(problem().dofs().size());
    on_.fields->read(field, of_part);
    on_.region->expand(load, of_part, whole);
    return on_.region->largest_outside(whole);
  }

  double residual() const {
    const shaders::Summary s = on_.fields->state();
    const double load = force_squared_ + s.reaction_squared;
    return load > 0 ? std::sqrt(s.residual_squared / load) : 0.0;
  }

  double tolerance() const { return problem().scene().solver.tolerance; }

  StressSummary do_stress() override {
    if (!needs().yield) return {};
    const shaders::Summary s = on_.fields->state();
    const auto worst = [this](double ratio, std::uint32_t element) {
      return ratio > 0 ? Worst{of_body(element), ratio} : Worst{};
    };
    return {worst(s.any_ratio, s.any_element), worst(s.candidate_ratio, s.candidate_element),
            static_cast<Index>(s.over)};
  }

  void do_destroy(std::span<const Index> elements) override {
    finish_display();
    if (on_.region) follow_outside(elements);
    check_.event();
    solved_ = false;
    const auto list = on_device(elements);
    destroyed_list_.insert(destroyed_list_.end(), list.begin(), list.end());
    on_.fields->destroy(list);
    on_.route->destroy(list, destroyed_list_);
  }

  /// What the scene says can be destroyed is in the region; for what else a host destroys it grows.
  void follow_outside(std::span<const Index> elements) {
    const std::size_t before = beyond_.size();
    for (Index e : elements) {
      if (on_.region->element(e) == kNone) beyond_.push_back(e);
    }
    if (beyond_.size() == before) return;
    try {
      grow();
    } catch (...) {
      beyond_.resize(before);
      throw;
    }
  }

  /// The region anew, with the elements `beyond_`. The last solution, damage, load and what is no
  /// candidate go over to it; nothing changes when it cannot be made.
  void grow() {
    static_cast<void>(whole_displacement());
    std::vector<Index> destroyed;
    for (Index e : destroyed_list_) destroyed.push_back(of_body(static_cast<std::uint32_t>(e)));
    OnDevice old = std::exchange(on_, OnDevice{});
    try {
      put_on_device(engine::region_of(problem(), needs(), beyond_));
      take_over_state(destroyed);
    } catch (...) {
      on_ = std::move(old);
      number_anew(destroyed);
      throw;
    }
  }

  /// Load and damage as the region on the device numbers them.
  void number_anew(std::span<const Index> destroyed) {
    force_.assign(on_.fields->rows(), 0.0);
    load_ = {};
    do_set_load(Load(whole_load_));
    const auto list = on_device(destroyed);
    destroyed_list_.assign(list.begin(), list.end());
  }

  void take_over_state(std::span<const Index> destroyed) {
    check_ = FrameCheck(problem(), plan_.fp64);
    number_anew(destroyed);
    show(whole_u_);
    on_.fields->exclude(on_device(excluded_));
    if (!destroyed_list_.empty()) {
      on_.fields->destroy(destroyed_list_);
      on_.route->destroy(destroyed_list_, destroyed_list_);
    }
    if (!instruments_) return;
    std::shared_ptr<InstrumentForces> forces = instruments_->forces();
    instruments_.emplace(*on_.body);
    instruments_->take_over(std::move(forces));
  }

  /// A displacement of all nodes of the problem, and the stress that goes with it.
  void show(std::span<const double> displacement) {
    std::vector<double> of_part(on_.body->dofs().size());
    for (Index n = 0; n < problem().node_count(); ++n) {
      if (on_.region->node(n) == kNone) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        of_part[3 * static_cast<std::size_t>(on_.region->node(n)) + axis] =
            displacement[3 * static_cast<std::size_t>(n) + axis];
      }
    }
    on_.fields->write_displacement(of_part);
    vulkan::Commands commands(*device_);
    commands.begin();
    on_.fields->record_state(commands, false);
    commands.end();
    commands.submit();
  }

  void do_exclude_candidates(std::span<const Index> elements) override {
    finish_display();
    if (on_.region) excluded_.insert(excluded_.end(), elements.begin(), elements.end());
    on_.fields->exclude(on_device(elements));  // outside the region nothing is a candidate
  }

  void do_solve_pristine(const Load& of_problem, std::span<double> displacement) override {
    const Load load = on_.region ? on_.region->load(of_problem) : of_problem;
    const Loaded loaded{load.force_dofs, load.forces};
    Eigen::VectorXd u = Eigen::VectorXd::Zero(on_.body->dof_count());
    const Eigen::MatrixXd columns = on_.intact->columns(load.force_dofs);
    for (std::size_t i = 0; i < load.forces.size(); ++i) {
      u += load.forces[i] * columns.col(static_cast<Index>(i));
    }
    if (on_.pristine->count() > 0) {
      u += on_.pristine->columns() *
           on_.pristine->coefficients(on_.pristine->project(loaded), load.displacements);
    }
    const std::span<const double> unknowns(u.data(), static_cast<std::size_t>(u.size()));
    if (!on_.region) {
      fem::scatter(problem(), unknowns, displacement);
      return;
    }
    std::vector<double> of_part(on_.body->dofs().size());
    fem::scatter(*on_.body, unknowns, of_part);
    on_.region->expand(of_problem, of_part, displacement);
  }

  /// Displacement of the last solution at all nodes of the problem: outside a region it is solved
  /// for, once a solution.
  std::span<const double> whole_displacement() const {
    if (whole_u_known_) return whole_u_;
    std::vector<double> of_part(on_.body->dofs().size());
    on_.fields->read_displacement(of_part);
    whole_u_.resize(problem().dofs().size());
    on_.region->expand(solved_load_, of_part, whole_u_);
    whole_u_known_ = true;
    return whole_u_;
  }

  void do_read_displacement(std::span<double> displacement) const override {
    if (!on_.region) {
      on_.fields->read_displacement(displacement);
      return;
    }
    const auto whole = whole_displacement();
    std::copy(whole.begin(), whole.end(), displacement.begin());
  }

  void do_read_displacement(std::span<const Index> nodes,
                            std::span<Vec3> displacement) const override {
    if (!on_.region) {
      read_nodes(nodes, displacement);
      return;
    }
    std::vector<Index> of_part;
    for (Index n : nodes) {
      if (on_.region->node(n) != kNone) of_part.push_back(on_.region->node(n));
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
      on_.fields->read_displacement(nodes, displacement);
      return;
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      displacement[i] = on_.fields->read_displacement(nodes[i]);
    }
  }

  void do_read_stress(std::span<Voigt> stress) const override {
    if (!on_.region) {
      on_.fields->read_stress(stress);
      return;
    }
    std::vector<Voigt> of_part(on_.body->mesh().tets.size());
    on_.fields->read_stress(of_part);
    for (std::size_t e = 0; e < of_part.size(); ++e) {
      stress[on_.region->region().elements[e]] = of_part[e];
    }
    on_.region->stress_outside(whole_displacement(), stress);
  }

  Voigt do_read_stress(Index element) const override {
    const Index e = on_.region ? on_.region->element(element) : element;
    if (e != kNone) return on_.fields->read_stress(e);
    return fem::stress(problem().shape(element), problem().material(element),
                       fem::corner_displacement(problem().mesh(), element, whole_displacement()));
  }

  void do_read_reactions(std::span<double> reactions) const override {
    on_.fields->read_reactions(on_.body->gripped_dofs(), reactions);
  }

  std::future<IntactInverse> started_;
  std::unique_ptr<vulkan::Device> device_;
  Plan plan_;
  KernelFactory kernels_;
  InverseOptions inverse_;  // of routes inverse and condensed
  struct OnDevice {
    std::unique_ptr<engine::Substructure> region;  // route condensed; null: the whole is there
    std::shared_ptr<const Problem> body;           // what the device has
    std::unique_ptr<Fields> fields;
    IntactInverse intact;
    std::unique_ptr<Correction> pristine;  // of the intact body: its grips
    std::unique_ptr<DeviceRoute> route;
  };
  OnDevice on_;
  FrameCheck check_;
  std::unique_ptr<Display> display_;
  Load load_;  // of on_.body
  // Of a region's problem: the load set, that of the last solution, and its displacement once read.
  Load whole_load_, solved_load_;
  mutable std::vector<double> whole_u_;
  mutable bool whole_u_known_ = false;
  std::vector<Index> in_part_;
  // Of a region's problem: what has been destroyed outside the region planned, and excluded.
  std::vector<Index> beyond_, excluded_;
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
