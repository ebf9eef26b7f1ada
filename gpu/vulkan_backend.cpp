// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan_backend.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>

#include "gpu/cg_route.hpp"
#include "gpu/choose_device.hpp"
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

class VulkanBackend final : public Backend {
 public:
  VulkanBackend(std::shared_ptr<const Problem> problem, Needs needs, const VulkanOptions& options)
      : Backend(problem, std::move(needs)),
        device_(open_device(options, problem->scene().solver.device)),
        plan_(make_plan(*problem, this->needs(), device_->physical())),
        kernels_(*device_, options.variant.value_or(choose_variant(device_->physical())),
                 plan_.fp64),
        inverse_{plan_.eager, problem->scene().solver.tolerance, options.panel_bytes,
                 options.invert_on_device.value_or(plan_.invert_on_device)},
        fields_(kernels_, *problem, this->needs(), route_needs(*problem)),
        check_(*problem, plan_.fp64) {
    if (!plan_.cg || this->needs().pristine) {
      intact_ = std::make_shared<HostInverse>(fem::assemble_lower(*problem, {}),
                                              !plan_.cg && !inverse_.on_device);
    }
    if (this->needs().pristine) {
      pristine_ = std::make_unique<Correction>(
          *problem, [host = intact_](std::span<const Index> dofs) { return host->columns(dofs); });
    }
    force_.assign(fields_.rows(), 0.0);
    device_->set_timing(false);
    if (options.lent) {
      display_ = std::make_unique<Display>(kernels_, *problem, fields_, this->needs().stress,
                                           options.display, options.lent->timeline_semaphore);
    }
    if (plan_.cg) {
      route_ = std::make_unique<CgRoute>(kernels_, *problem, fields_);
      return;
    }
    if (kernels_.single()) {
      route_ = std::make_unique<HostCorrectedRoute>(kernels_, *problem, fields_, intact_,
                                                    inverse_.panel_bytes);
      return;
    }
    route_ = std::make_unique<InverseRoute>(kernels_, *problem, fields_, intact_, inverse_);
  }

  BackendInfo info() const override {
    BackendInfo info;
    info.backend = "vulkan";
    info.device = device_->physical().name;
    info.driver = device_->physical().driver;
    info.precision = plan_.fp64 ? "fp64" : "fp32";
    info.route = route_->name();
    info.update = needs().damage ? route_->update() : "none";
    info.why = plan_.why;
    for (const BufferPlan& b : buffers()) info.memory_bytes += b.bytes;
    return info;
  }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = route_->buffers();
    for (BufferPlan& b : fields_.buffers()) plan.push_back(std::move(b));
    return plan;
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
  std::vector<Index> over_yield() const { return fields_.over_yield(); }
  std::size_t bytes_read() const { return device_->bytes_read(); }
  Display* display() { return display_.get(); }

 private:
  /// What a host's submit still reads must not be written.
  void finish_display() {
    if (display_) display_->finish();
  }

  [[nodiscard]] Fields::RouteNeeds route_needs(const Problem& problem) const {
    if (plan_.cg) return {CgRoute::planned_bytes(problem), true};
    if (kernels_.single()) {
      return {HostCorrectedRoute::planned_bytes(kernels_, problem, inverse_.panel_bytes), false};
    }
    return {InverseRoute::planned_bytes(kernels_, problem, inverse_), false};
  }

  void do_set_load(const Load& load) override {
    finish_display();
    for (Index d : load_.force_dofs) force_[d] = 0;
    load_ = load;
    force_squared_ = 0;
    for (std::size_t i = 0; i < load.forces.size(); ++i) {
      force_[load.force_dofs[i]] = load.forces[i];
      force_squared_ += load.forces[i] * load.forces[i];
    }
    fields_.set_load(force_, load.displacements);
  }

  SolveReport do_solve() override {
    finish_display();
    if (!check_.known(load_)) fields_.keep_next();
    try {
      return solve_within_tolerance();
    } catch (const NumericalError&) {
      check_.event();
      fields_.restore();  // results so far stay readable
      throw;
    }
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
      report.iterations = route_->solve(load_, !problem().gripped_dofs().empty());
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
    const double of_u = std::sqrt(fields_.state().stress_squared);
    const double of_du = std::sqrt(fields_.correction().stress_squared);
    if (!std::isfinite(residual())) return residual();
    if (!std::isfinite(of_u)) return of_u;
    return of_du == 0 ? 0.0 : of_du / of_u;
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
    const auto worst = [](double ratio, std::uint32_t element) {
      return ratio > 0 ? Worst{static_cast<Index>(element), ratio} : Worst{};
    };
    return {worst(s.any_ratio, s.any_element), worst(s.candidate_ratio, s.candidate_element),
            static_cast<Index>(s.over)};
  }

  void do_destroy(std::span<const Index> elements) override {
    finish_display();
    check_.event();
    destroyed_list_.insert(destroyed_list_.end(), elements.begin(), elements.end());
    fields_.destroy(elements);
    route_->destroy(elements, destroyed_list_);
  }

  void do_exclude_candidates(std::span<const Index> elements) override {
    finish_display();
    fields_.exclude(elements);
  }

  void do_solve_pristine(const Load& load, std::span<double> displacement) override {
    const Loaded loaded{load.force_dofs, load.forces};
    Eigen::VectorXd u = Eigen::VectorXd::Zero(problem().dof_count());
    const Eigen::MatrixXd columns = intact_->columns(load.force_dofs);
    for (std::size_t i = 0; i < load.forces.size(); ++i) {
      u += load.forces[i] * columns.col(static_cast<Index>(i));
    }
    if (pristine_->count() > 0) {
      u += pristine_->columns() *
           pristine_->coefficients(pristine_->project(loaded), load.displacements);
    }
    fem::scatter(problem(), {u.data(), static_cast<std::size_t>(u.size())}, displacement);
  }

  void do_read_displacement(std::span<double> displacement) const override {
    fields_.read_displacement(displacement);
  }

  void do_read_displacement(std::span<const Index> nodes,
                            std::span<Vec3> displacement) const override {
    if (nodes.size() <= kFewNodes) {
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        displacement[i] = fields_.read_displacement(nodes[i]);
      }
      return;
    }
    fields_.read_displacement(nodes, displacement);
  }

  void do_read_stress(std::span<Voigt> stress) const override { fields_.read_stress(stress); }
  Voigt do_read_stress(Index element) const override { return fields_.read_stress(element); }

  void do_read_reactions(std::span<double> reactions) const override {
    fields_.read_reactions(problem().gripped_dofs(), reactions);
  }

  std::unique_ptr<vulkan::Device> device_;
  Plan plan_;
  KernelFactory kernels_;
  InverseOptions inverse_;  // of route inverse
  Fields fields_;
  FrameCheck check_;
  std::shared_ptr<const HostInverse> intact_;
  std::unique_ptr<Correction> pristine_;  // of the intact body: its grips
  std::unique_ptr<Display> display_;
  std::unique_ptr<DeviceRoute> route_;
  Load load_;
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

}  // namespace sunder::gpu
