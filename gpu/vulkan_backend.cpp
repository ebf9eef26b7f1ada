// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan_backend.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <iomanip>
#include <sstream>
#include <utility>

#include "gpu/choose_device.hpp"
#include "gpu/condensed_body.hpp"
#include "gpu/law_machine.hpp"
#include "gpu/plan_device.hpp"
#include "gpu/whole_body.hpp"
#include "solver/frame_solver.hpp"
#include "solver/instrument_block.hpp"
#include "solver/route_table.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

std::unique_ptr<vulkan::Device> open_device(const VulkanOptions& options, int asked) {
  if (options.lent) return vulkan::borrow_device(*options.lent, options.probe, options.cache);
  const auto instance = std::make_shared<vulkan::Instance>(options.instance);
  return vulkan::create_device(instance, choose_device(*instance, asked, options.probe),
                               options.probe, options.cache);
}

/// On a thread of its own, while loader, device and pipelines are made ready.
std::future<IntactInverse> start_inverse(const Problem& problem, const VulkanOptions& options) {
  if (options.invert_on_device.value_or(false) || !host_inverts_anyway(problem)) return {};
  return std::async(std::launch::async,
                    [&problem] { return std::make_shared<const HostInverse>(problem, true); });
}

solver::PlanDevice device_to_plan(const VulkanOptions& options, const vulkan::Device& device) {
  solver::PlanDevice plan = plan_device(device.physical(), options.lent.has_value());
  if (options.invert_on_device) plan.inverts_from = *options.invert_on_device ? 1 : kNone;
  return plan;
}

/// From so many values on the columns of a region are the device's to multiply: the host reads them
/// in .2 ms, against one more submit.
std::optional<std::size_t> region_from(const VulkanOptions& options,
                                       const vulkan::PhysicalDevice& device, const Needs& needs) {
  constexpr std::size_t kLeast = std::size_t{1} << 18;
  if (!needs.damage || !device.float64) return {};
  if (options.region_on_device) {
    return *options.region_on_device ? std::optional<std::size_t>(0) : std::nullopt;
  }
  return device.is_cpu() ? std::nullopt : std::optional(kLeast);
}

/// From so many columns on the small matrices are the device's.
std::optional<Index> damage_from(const VulkanOptions& options, const vulkan::PhysicalDevice& device,
                                 const solver::FrameRates& rates, const Needs& needs) {
  if (!needs.damage || !device.float64) return {};
  if (options.damage_on_device) {
    return *options.damage_on_device ? std::optional<Index>(1) : std::nullopt;
  }
  return device.is_cpu() ? std::nullopt : solver::columns_worth_a_device(rates);
}

class VulkanBackend final : public Backend {
 public:
  VulkanBackend(std::shared_ptr<const Problem> problem, Needs needs, const VulkanOptions& options)
      : Backend(problem, std::move(needs)),
        started_(start_inverse(*problem, options)),
        device_(open_device(options, problem->scene().solver.device)),
        for_plan_(device_to_plan(options, *device_)),
        plan_(solver::make_plan(*problem, this->needs(), for_plan_)),
        kernels_(*device_, options.variant.value_or(choose_variant(device_->physical())),
                 plan_.fp64),
        inverse_{plan_.eager,
                 options.panel_bytes,
                 plan_.invert_on_device,
                 plan_.exact_inverse,
                 region_from(options, device_->physical(), this->needs()),
                 damage_from(options, device_->physical(), for_plan_.rates, this->needs()),
                 [this](std::string what) { leave_out(std::move(what)); }} {
    device_->set_timing(false);
    for (const std::string& what : plan_.left_out) leave_out(what);
    const DeviceSetup setup{damaged_body(), kernels_, plan_, inverse_, this->needs()};
    if (plan_.region) {
      body_ = std::make_unique<CondensedBody>(setup, *plan_.region);
    } else {
      body_ = std::make_unique<WholeBody>(setup, std::move(started_));
    }
    solver_.emplace(*problem, body_->frame());
    if (options.lent) {
      body_->fields().show();
      display_ = std::make_unique<Display>(kernels_, this->problem(), body_->fields(),
                                           this->needs().stress, options.display,
                                           options.lent->timeline_semaphore);
    }
    device_->flush();  // a device that is lost already is known now, not in the first frame
  }

  BackendInfo info() const override {
    BackendInfo info;
    info.backend = "vulkan";
    info.device = device_->physical().name;
    info.driver = device_->physical().driver;
    info.precision = plan_.fp64 ? "fp64" : "fp32";
    info.route = solver::name_of(plan_.route);
    info.update = needs().damage ? solver::name_of_update(plan_) : "none";
    if (plan_.eager && body_->update()) info.update = "deferred";  // rounding has made it so
    info.why = plan_.why;
    for (const BufferPlan& b : buffers()) info.memory_bytes += b.bytes;
    const solver::FrameCost cost = predicted(rates());
    info.predicted_by =
        for_plan_.rates.measured ? "rates measured on the device" : "nominal rates of such devices";
    info.quiet_ms = cost.quiet.ms;
    info.fracture_ms = cost.fracture.ms;
    return info;
  }

  std::vector<BufferPlan> buffers() const override { return body_->buffers(); }

  std::vector<KernelPlan> kernels() const override { return describe(device_->living_pipelines()); }

  NewBases take_new_bases() override {
    const NewBases all = body_->new_bases(), before = std::exchange(taken_, all);
    return {all.count - before.count, all.waited_ms - before.waited_ms};
  }
  std::shared_ptr<InstrumentForces> instrument_forces() override {
    if (!instruments_ && has_grips() && body_->grip_factor()) {
      instruments_.emplace(problem());
      if (solved_) publish_instruments();
    }
    return instruments_ ? instruments_->forces() : nullptr;
  }
  void take_over_instrument_forces(std::shared_ptr<InstrumentForces> forces) override {
    if (instrument_forces()) instruments_->take_over(std::move(forces));
  }

  std::vector<std::string> warnings() const override {
    if (!loosest_) return {};
    std::ostringstream text;
    text
        << std::setprecision(2)
        << "stress is right to solver.tolerance as it is computed; handing it out in fp32 may cost "
           "more: error is up to "
        << *loosest_ << "; use precision fp64";
    if (display_) text << " and read the fields instead of the buffers that are drawn";
    return {text.str()};
  }

  void time_passes(bool on) override { device_->set_timing(on); }
  std::vector<PassTime> take_pass_times() override {
    std::vector<PassTime> times;
    for (const vulkan::PassTime& t : device_->take_times()) {
      times.push_back({t.pass, t.milliseconds});
    }
    return times;
  }

  [[nodiscard]] const solver::FrameRates& rates() const { return for_plan_.rates; }
  solver::FrameCost predicted(const solver::FrameRates& by) const {
    return solver::frame_cost(shape(), by);
  }
  DeviceUse device_use() const {
    return {device_->held_bytes(), device_->most_bytes(), device_->queue().submits(),
            device_->pipelines(),  device_->dispatches(), device_->recorded(),
            body_->host_solves()};
  }
  std::vector<Index> over_yield() const {
    std::vector<Index> list = body_->fields().over_yield();
    for (Index& e : list) e = body_->of_whole(static_cast<std::uint32_t>(e));
    return list;
  }
  std::size_t bytes_read() const { return device_->bytes_read(); }
  const std::vector<std::string>& plan_warnings() const { return plan_.warnings; }
  Display* display() { return display_.get(); }
  LentField lent_field() {
    if (!display_) return {};
    const Fields& fields = body_->fields();
    return {&kernels_, &fields.nodal(Field::displacement),
            needs().stress ? &fields.stress() : nullptr};
  }

 private:
  [[nodiscard]] solver::FrameShape shape() const {
    solver::FrameShape shape = plan_.shape(problem(), needs());
    const bool whole = !plan_.region;
    if (whole) shape.kept = body_->fields().rows();
    shape.elements = body_->part().mesh().tets.size();
    shape.stressed = body_->fields().norms() ? shape.elements : 0;
    shape.apart = whole;
    shape.host_corrects = kernels_.single();
    shape.stress = needs().stress;
    shape.real_bytes = shape.inverse_bytes = kernels_.real_bytes();
    shape.exact_loads = kExactLoads;
    shape.stiffness_bytes = whole ? body_->fields().matrix().bytes() : 0;
    body_->add_to(shape);
    return shape;
  }

  /// What a host's submit still reads must not be written.
  void finish_display() {
    if (display_) display_->finish();
  }

  void do_set_load(const Load& load) override {
    finish_display();
    load_ = load;
    solved_ = false;
    body_->set_load(load);
  }

  SolveReport do_solve() override {
    finish_display();
    const bool known = solver_->known(load_);
    if (!known) body_->keep();
    try {
      SolveReport report = solver_->solve(load_);
      body_->publish(solver_->everywhere());
      const double waited = body_->new_bases().waited_ms;
      report.waited_ms = waited - waited_ms_;
      waited_ms_ = waited;
      if (!known) handed_out_ = handed_out();  // linear in the load, as the rest of the error
      add_handed_out(report);
      solved_ = true;
      grasped_since_.clear();
      if (instruments_) publish_instruments();
      return report;
    } catch (const NumericalError&) {
      solver_->event();
      body_->restore();  // results so far stay readable
      throw;
    }
  }

  /// What rounding on the way out may cost, by the largest stress. No refinement helps against it.
  double handed_out() const {
    const double bound = body_->fields().handed_out();
    return bound > 0 ? bound / body_->fields().largest_stress(Field::displacement) : 0.0;
  }

  void add_handed_out(SolveReport& report) {
    report.error += handed_out_;
    if (!(report.error > tolerance())) return;
    if (report.error > loosest_.value_or(0)) loosest_ = report.error;
  }

  /// Only once somebody has asked for them: the reactions are read back from the device.
  void publish_instruments() {
    if (load_.displacements.size() != gripped_dofs().size()) return;  // of other grips
    reactions_.resize(gripped_dofs().size());
    body_->read_reactions(reactions_);
    instruments_->publish(gripped_dofs(), *body_->grip_factor(), reactions_, load_.displacements);
  }

  double tolerance() const { return problem().scene().solver.tolerance; }

  StressSummary do_stress() override {
    body_->publish_stress();
    if (!needs().yield) return {};
    const shaders::Summary s = body_->fields().state();
    const auto worst = [this](double ratio, std::uint32_t element) {
      return ratio > 0 ? Worst{body_->of_whole(element), ratio} : Worst{};
    };
    return {worst(s.any_ratio, s.any_element), worst(s.candidate_ratio, s.candidate_element),
            static_cast<Index>(s.over)};
  }

  /// A piece that came off was still in the sums of the frame that set it loose.
  Deformation do_deformation() override {
    if (renew_) body_->fields().renew_state();
    renew_ = false;
    return body_->fields().deformation();
  }

  void do_cut_off(std::span<const Index> elements) override {
    finish_display();
    body_->cut_off(elements);
    renew_ = true;
  }

  void do_destroy(std::span<const Index> elements) override {
    finish_display();
    solver_->event();
    solved_ = false;
    body_->destroy(elements);
  }

  std::string why_no_grasp() const override {
    if (plan_.eager) {
      return "on backend vulkan update eager holds the scene's grips alone; take update deferred, "
             "or "
             "backend cpu";
    }
    return {};
  }

  void do_grip(const GripChange& change) override {
    finish_display();
    solver_->grips_changed();
    body_->grip({.grasp = change.grasp, .release = change.release}, change.before);
    for (Index d : change.release) std::erase(grasped_since_, d);
    grasped_since_.insert(grasped_since_.end(), change.grasp.begin(), change.grasp.end());
  }

  void do_prepare(std::span<const Index> elements) override { body_->prepare(elements); }
  void do_exclude_candidates(std::span<const Index> elements) override {
    finish_display();
    body_->exclude(elements);
  }

  void do_solve_pristine(const Load& load, std::span<double> displacement) override {
    body_->solve_pristine(load, displacement);
  }
  void do_read_displacement(std::span<double> displacement) const override {
    body_->read_displacement(displacement);
  }
  void do_read_displacement(std::span<const Index> nodes,
                            std::span<Vec3> displacement) const override {
    body_->read_displacement(nodes, displacement);
  }
  void do_read_stress(std::span<Voigt> stress) const override { body_->read_stress(stress); }
  Voigt do_read_stress(Index element) const override { return body_->read_stress(element); }
  void do_read_reactions(std::span<double> reactions) const override {
    body_->read_reactions(reactions);
    for (std::size_t g = reactions.size() - grasped_since_.size(); g < reactions.size(); ++g) {
      reactions[g] = 0;  // the last ones, of which the last solution knows nothing
    }
  }

  std::future<IntactInverse> started_;
  std::unique_ptr<vulkan::Device> device_;
  solver::PlanDevice for_plan_;
  solver::Plan plan_;
  KernelFactory kernels_;
  InverseOptions inverse_;  // of routes inverse and condensed
  std::unique_ptr<DeviceBody> body_;
  std::optional<solver::FrameSolver> solver_;
  double waited_ms_ = 0;  // for new bases, as reported so far by solve()
  NewBases taken_;        // by take_new_bases() so far
  std::unique_ptr<Display> display_;
  Load load_;
  bool renew_ = false;  // the summary was made before the last pieces were cut off
  std::optional<solver::InstrumentBlock> instruments_;  // once asked for
  std::vector<double> reactions_;
  std::vector<Index> grasped_since_;  // the last solution
  bool solved_ = false;               // the load and the damage as they are
  double handed_out_ = 0;             // of the last solution whose error was estimated
  std::optional<double> loosest_;     // error over the tolerance for what handing out costs
};

}  // namespace

std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs) {
  return create(std::move(problem), std::move(needs), options_from_environment());
}

std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs,
                                const VulkanOptions& options) {
  if (!problem) throw UsageError("a backend needs a problem");
  // New nodes and unknowns come with tangents of the body as it is, whatever its law.
  if (problem->moves() || problem->finite() || problem->fibrous() || needs.split) {
    finite::Machine machine = law_machine(*problem, options);
    return finite::create(std::move(problem), std::move(needs), std::move(machine));
  }
  return std::make_unique<VulkanBackend>(std::move(problem), std::move(needs), options);
}

Display* display_of(Backend& backend) {
  auto* of_vulkan = dynamic_cast<VulkanBackend*>(&backend);
  return of_vulkan ? of_vulkan->display() : nullptr;
}

LentField lent_field(Backend& backend) {
  auto* of_vulkan = dynamic_cast<VulkanBackend*>(&backend);
  return of_vulkan ? of_vulkan->lent_field() : LentField{};
}

DeviceUse device_use(const Backend& backend) {
  const auto* vulkan_backend = dynamic_cast<const VulkanBackend*>(&backend);
  return vulkan_backend ? vulkan_backend->device_use() : DeviceUse{};
}

solver::FrameCost predicted(const Backend& backend, const std::optional<solver::FrameRates>& by) {
  const auto* vulkan_backend = dynamic_cast<const VulkanBackend*>(&backend);
  if (!vulkan_backend) return {};
  return vulkan_backend->predicted(by ? *by : vulkan_backend->rates());
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
  return vulkan_backend ? vulkan_backend->plan_warnings() : std::vector<std::string>{};
}

}  // namespace sunder::gpu
