// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

#include "cpu_reference/choose_route.hpp"
#include "cpu_reference/condensed_fields.hpp"
#include "cpu_reference/cost_model.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "cpu_reference/energy_check.hpp"
#include "cpu_reference/frame_check.hpp"
#include "cpu_reference/load_room.hpp"
#include "cpu_reference/recent_checks.hpp"
#include "cpu_reference/routes.hpp"
#include "engine/instrument_block.hpp"
#include "engine/stress_kernel.hpp"
#include "sunder/error.hpp"

namespace sunder::cpu_reference {
namespace {

// A full check refines silently down to these stress errors, for the yardstick a tenth of what
// double precision promises for an intact body; only frames over the scene's tolerance count as
// polished.
constexpr double kReferenceError = 1e-10, kDeferredError = 1e-9;
constexpr int kRefinements = 4;
std::string cpu_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "CPU";
}

std::string eigen_version() {
  return "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." +
         std::to_string(EIGEN_MAJOR_VERSION) + "." + std::to_string(EIGEN_MINOR_VERSION);
}

class CpuBackend final : public Backend {
 public:
  CpuBackend(std::shared_ptr<const Problem> problem, Needs needs, ChosenRoute chosen)
      : Backend(problem, std::move(needs)),
        chosen_(std::move(chosen)),
        body_(problem),
        intact_(*problem, this->needs().damage && chosen_.update == Update::deferred &&
                              chosen_.route != Route::condensed && chosen_.route != Route::cg) {
    const auto n = problem->dof_count();
    reserve(load_, *problem);
    if (this->needs().damage && problem->scene().solver.prepare) reserve_prepared();
    if (chosen_.route == Route::condensed) {
      condensed_.emplace(*problem, engine::region_of(*problem, this->needs()));
      if (problem->scene().fracture.model != FractureModel::none) {
        condensed_->make_room(this->needs().stress);
      }
    }
    route_ = make_route();
    if (condensed_) {
      energy_checks_.emplace(*problem);
    } else if (route_->deferred()) {
      checks_.emplace(*problem);
    }
    force_.setZero(n);
    u_.setZero(n);
    if (this->needs().pristine) {  // so that the first time allocates no more than the next
      pristine_force_.setZero(n);
      intact_.solve(pristine_force_, {}, pristine_u_);
    }
    reactions_.assign(problem->gripped_dofs().size(), 0.0);
    anchors_ = engine::anchors_of(*problem);
    if (route_->deferred() && !anchors_.empty()) instruments_.emplace(*problem);
    nodal_.assign(problem->dofs().size(), 0.0);
    next_nodal_ = nodal_;
    make_stress();
    if (checks_ && kernel_) {
      kernel_->keep_forces();
      nodal_forces_ = nodal_;
    }
    if (!condensed_) return;
    for (std::string& what : engine::left_out_of(*problem, condensed_->region())) {
      leave_out(std::move(what));
    }
  }

  BackendInfo info() const override {
    BackendInfo info;
    info.backend = "cpu";
    info.device = cpu_name();
    info.driver = eigen_version();
    info.precision = "fp64";
    info.route = name_of(chosen_.route);
    info.update = needs().damage ? name_of_update(chosen_) : "none";
    info.why = chosen_.why;
    for (const BufferPlan& b : buffers()) info.memory_bytes += b.bytes;
    const FrameCost cost = frame_cost(shape());
    info.quiet_ms = cost.quiet_ms;
    info.fracture_ms = cost.fracture_ms;
    return info;
  }

  std::vector<BufferPlan> buffers() const override {
    const auto bytes = [](const auto& v) { return v.size() * sizeof(v[0]); };
    std::vector<BufferPlan> plan = route_->buffers();
    plan.push_back({"intact factor (sparse Cholesky)", intact_.factor.bytes()});
    if (!intact_.grips.none()) {
      plan.push_back({"compliance columns of grips", intact_.grips.bytes()});
    }
    plan.push_back({"displacement and forces",
                    bytes(nodal_) * 4 + 2 * sizeof(double) * static_cast<std::size_t>(u_.size())});
    if (!stress_.empty()) {
      plan.push_back({"element stress", bytes(stress_)});
      plan.push_back({"element stress of the next frame", bytes(next_stress_)});
    }
    if (kernel_) plan.push_back({"shapes and elasticity of elements", kernel_->bytes()});
    if (condensed_ && condensed_->bytes() > 0) {
      plan.push_back({"fields outside the condensed region", condensed_->bytes()});
    }
    return plan;
  }

 private:
  FrameShape shape() const {
    FrameShape shape;
    shape.route = chosen_.route;
    shape.eager = chosen_.update == Update::eager;
    shape.damage = needs().damage;
    shape.unknowns = static_cast<std::size_t>(problem().dof_count());
    shape.kept = condensed_ ? condensed_->region().dofs.size() : shape.unknowns;
    for (const InstrumentNodes& i : problem().instrument_nodes()) {
      shape.loaded += 3 * std::max<std::size_t>(i.nodes.size(), 2);  // 2: a press
    }
    shape.entries = intact_.factor.entries();
    shape.path = intact_.factor.path_entries(an_element_that_can_break());
    shape.elements = problem().mesh().tets.size();
    shape.stressed = kernel_ ? kernel_->size() : 0;
    shape.threads = kernel_ ? static_cast<std::size_t>(kernel_->threads()) : 1;
    return shape;
  }

  /// Unknowns of one: the middle one that the scene itself can destroy, or of all.
  std::vector<Index> an_element_that_can_break() const {
    std::vector<Index> all, dofs;
    for (Index e = 0; e < problem().tet_count(); ++e) {
      if (problem().breakable(e)) all.push_back(e);
    }
    const Index e = all.empty() ? problem().tet_count() / 2 : all[all.size() / 2];
    for (Index n : problem().mesh().tets[e]) {
      for (int axis = 0; axis < 3; ++axis) {
        if (problem().dof(n, axis) != kNone) dofs.push_back(problem().dof(n, axis));
      }
    }
    return dofs;
  }

  void make_stress() {
    std::vector<Index> elements;  // none: all
    if (condensed_) elements = condensed_->region().elements;
    if (condensed_ && elements.empty()) return;
    if (needs().stress || needs().damage) {
      kernel_.emplace(body_.shared_problem(), std::move(elements), 0);
    }
    if (needs().stress) {
      stress_.assign(kernel_->size(), Voigt::Zero());
      next_stress_ = stress_;
    }
    if (needs().yield) {
      excluded_.assign(problem().mesh().tets.size(), 0);
      kernel_->keep_bounds();
    }
  }

  std::unique_ptr<InverseRoute> make_route() {
    if (chosen_.route == Route::cg) return conjugate_gradient_route(body_, intact_);
    if (condensed_ && chosen_.update == Update::eager) {
      return condensed_eager_route(body_, intact_, condensed_->region().dofs);
    }
    if (condensed_) {
      return condensed_route(body_, intact_, condensed_->region().dofs, needs().damage);
    }
    if (chosen_.update == Update::eager) return dense_inverse_route(body_, intact_);
    return deferred_route(body_, intact_, chosen_.route == Route::inverse);
  }

  void do_set_load(const Load& load) override {
    for (Index d : load_.force_dofs) force_[d] = 0;
    load_ = load;
    for (std::size_t i = 0; i < load.forces.size(); ++i)
      force_[load.force_dofs[i]] = load.forces[i];
  }

  std::shared_ptr<InstrumentForces> instrument_forces() override {
    return instruments_ ? instruments_->forces() : nullptr;
  }
  void take_over_instrument_forces(std::shared_ptr<InstrumentForces> forces) override {
    if (instruments_) instruments_->take_over(std::move(forces));
  }

  bool prepares() const override { return needs().damage && route_->prepares(); }

  PreparationReport preparation() const override {
    PreparationReport report = preparation_;
    report.saved_ms = route_->saved_ms();
    return report;
  }

  void reserve_prepared() {
    is_prepared_.reserve(problem().mesh().tets.size());
    prepared_.reserve(std::min(is_prepared_.capacity(), std::size_t{1} << 14));
  }

  void do_prepare(std::span<const Index> elements) override {
    using Clock = std::chrono::steady_clock;
    if (!prepares()) return;
    const auto start = Clock::now();
    is_prepared_.assign(problem().mesh().tets.size(), 0);
    prepared_.clear();
    reserve_prepared();
    for (Index e : elements) {
      if (body_.destroyed()[e] || is_prepared_[e]) continue;
      is_prepared_[e] = 1;
      prepared_.push_back(e);
    }
    route_->prepare(prepared_);
    preparation_.spent_ms +=
        std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }

  SolveReport do_solve() override {
    SolveReport report = solve_and_check();
    report.waited_ms = route_->waited_ms() - waited_ms_;
    waited_ms_ = route_->waited_ms();
    if (instruments_) {
      instruments_->publish(route_->deferred()->grip_factor(), reactions_, load_.displacements);
    }
    return report;
  }

  SolveReport solve_and_check() {
    fresh_ = false;
    if (condensed_) return solve_condensed();
    SolveReport report;
    check_ = check_of_load();
    const auto scale = check_ ? check_->scale_of(load_, *route_) : std::nullopt;
    route_->set_enough(scale ? check_->enough(*scale) : 0);
    solve_by(*route_, report);
    const auto known =
        scale && route_->deferred()->converged() ? check_->error(*scale, solution()) : std::nullopt;
    if (known) {
      report.error = *known;
    } else {
      check_fully(report);
    }
    if (!fast()) hand_out();
    nodal_.swap(next_nodal_);
    return report;
  }

  /// Nothing: the route is checked fully in any case.
  FrameCheck* check_of_load() {
    if (!checks_) return nullptr;
    for (FrameCheck& check : checks_->all()) check.follow(*route_);
    return &checks_->of(load_, *route_);
  }

  /// A condensed frame has no residual outside its region: the energy of what damage lacks bounds
  /// its error.
  SolveReport solve_condensed() {
    for (EnergyCheck& each : energy_checks_->all()) each.follow(*route_);
    EnergyCheck& check = energy_checks_->of(load_, *route_);
    if (const auto known = solve_on_region(check)) {
      nodal_.swap(next_nodal_);
      condensed_->take(*route_);
      return *known;
    }
    route_->set_enough(0);
    SolveReport report;
    solve_by(*route_, report);
    check_fully(report);
    hand_out();
    nodal_.swap(next_nodal_);
    take_everywhere();
    check.checked(load_, report, unrefined_, route_->bases(), largest_in_region(nodal_), largest_);
    return report;
  }

  /// The solution without a full check, where one like it has had its check.
  std::optional<SolveReport> solve_on_region(EnergyCheck& check) {
    const auto expected = check.expected(load_, *route_);
    if (!expected) return std::nullopt;
    route_->set_enough(check.enough(*expected));
    route_->solve(load_, force_, u_);
    hand_out();
    const auto gripped = problem().gripped_dofs();
    for (std::size_t g = 0; g < gripped.size(); ++g) {
      reactions_[g] = grip_force(g) - anchors_[g] * u_[gripped[g]];  // the anchor's share
    }
    return check.known(*expected, *route_, largest_in_region(next_nodal_), largest_);
  }

  double grip_force(std::size_t g) const {
    if (!route_->deferred()) return route_->grip_force(g);
    return route_->deferred()->grip_forces()[static_cast<Eigen::Index>(g)];
  }

  /// Whether residual and stress come from the kernel; the yardstick has loops of its own.
  bool fast() const { return checks_ && kernel_; }

  FrameCheck::Solution solution() const { return {free_residual_, largest_u(), largest_}; }

  void check_fully(SolveReport& report) {
    refine(*route_, report);
    if (!(report.error <= tolerance())) polish(report);
    if (!(report.error <= tolerance())) fail(report);
  }

  double largest_in_region(std::span<const double> u) const {
    double largest = 0;
    for (Index n : condensed_->region().nodes) {
      for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(u[3 * n + axis]));
    }
    return largest;
  }

  /// The last solution holds at every node: it has had its full check.
  void take_everywhere() {
    fem::scatter(problem(), {u_.data(), static_cast<std::size_t>(u_.size())}, nodal_);
    condensed_->take(nodal_);
  }
  /// The solution by a route, with its residual.
  void solve_by(InverseRoute& route, SolveReport& report) {
    report.iterations += route.solve(load_, force_, u_).iterations;
    route.complete(u_);
    look_at(report);
  }

  double largest_u() const { return u_.size() > 0 ? u_.cwiseAbs().maxCoeff() : 0.0; }

  /// Displacement at all nodes, and its stress, which do_stress() publishes.
  void hand_out() {
    if (condensed_) {
      for (Index n : condensed_->region().nodes) {
        for (int axis = 0; axis < 3; ++axis) {
          const Index d = problem().dof(n, axis);
          if (d != kNone) next_nodal_[3 * n + axis] = u_[d];
        }
      }
    } else {
      fem::scatter(problem(), {u_.data(), static_cast<std::size_t>(u_.size())}, next_nodal_);
    }
    if (!kernel_) return;
    largest_ = kernel_->run(next_nodal_, next_stress_);
    fresh_ = true;
  }

  /// Corrects the solution by a route until the estimate is rounding's.
  void refine(InverseRoute& route, SolveReport& report) {
    const double enough = checks_ ? kDeferredError : kReferenceError;
    report.error = std::numeric_limits<double>::infinity();
    for (int attempt = 0;; ++attempt) {
      const double stress = correction(route, report);
      const double error = stress == 0 ? 0.0 : stress / largest_;
      if (attempt == 0) {
        unrefined_ = error;
        if (check_ && &route == route_.get()) {
          check_->checked(load_, solution(), stress, route_->bases());
        }
        report.polished = report.polished || !(error <= tolerance());
      }
      // A correction that no longer shrinks is rounding.
      const bool stalled = attempt > 0 && !(error < report.error / 2);
      report.error = error;
      if (!std::isfinite(error)) return;  // overflow: there is no correction
      const bool done = error <= enough && (attempt > 0 || !yardstick());
      if (done || attempt == kRefinements || stalled) return;
      u_ += du_;
      look_at(report);
    }
  }

  /// Refinement converges only while the updated inverse is one; once it has drifted too far it is
  /// computed anew, and if that is not enough conjugate gradients on the intact base have the word.
  void polish(SolveReport& report) {
    if (route_->rebase()) {
      solve_by(*route_, report);
      refine(*route_, report);
    }
    if (report.error <= tolerance() || chosen_.route == Route::cg) return;
    const auto cg = conjugate_gradient_route(body_, intact_);
    solve_by(*cg, report);
    refine(*cg, report);
  }

  [[noreturn]] void fail(const SolveReport& report) const {
    std::ostringstream message;
    message << "the solution cannot be brought under the tolerance: estimated stress error "
            << report.error << ", residual " << report.residual
            << "; raise solver.tolerance or ease contrast, Poisson's ratio or slivers";
    throw NumericalError(message.str());
  }

  /// Residual f - K u and reactions of the solution, and its largest stress.
  void look_at(SolveReport& report) {
    if (fast()) {
      hand_out();
      kernel_->nodal_forces(nodal_forces_);
      product_.resize(u_.size());
      fem::gather(problem(), nodal_forces_,
                  {product_.data(), static_cast<std::size_t>(product_.size())});
    } else {
      body_.apply(u_, product_);
      largest_ = body_.largest_stress(u_);
    }
    r_ = force_ - product_;
    const auto gripped = problem().gripped_dofs();
    double load_norm = force_.squaredNorm();
    for (std::size_t g = 0; g < gripped.size(); ++g) {
      reactions_[g] = -r_[gripped[g]];  // what the grip adds to the applied force
      load_norm += reactions_[g] * reactions_[g];
      r_[gripped[g]] = 0;
    }
    free_residual_ = r_.norm();
    report.residual = load_norm > 0 ? free_residual_ / std::sqrt(load_norm) : 0.0;
  }

  /// du = A^-1 (f - K u); returns its largest stress over live elements.
  double correction(InverseRoute& route, SolveReport& report) {
    if (!std::isfinite(report.residual)) return report.residual;
    report.iterations += route.apply(r_, du_).iterations;
    if (!fast()) return body_.largest_stress(du_);
    fem::scatter(problem(), {du_.data(), static_cast<std::size_t>(du_.size())}, nodal_forces_);
    return kernel_->largest(nodal_forces_);
  }

  /// The plain routes are what others are measured by: they refine once in any case.
  bool yardstick() const {
    return chosen_.route == Route::cg ||
           (chosen_.route == Route::inverse && chosen_.update == Update::eager);
  }

  double tolerance() const { return problem().scene().solver.tolerance; }

  StressSummary do_stress() override {
    if (fresh_) std::swap(stress_, next_stress_);
    fresh_ = false;
    stressed_ = true;
    if (condensed_) condensed_->publish_stress();
    if (!needs().yield || !kernel_) return {};
    return kernel_->summarize(excluded_, stress_);
  }

  void do_destroy(std::span<const Index> elements) override {
    // What lies outside the region and has a stress keeps it, whatever it is scaled by from now on.
    if (condensed_ && stressed_ && !std::ranges::all_of(elements, [this](Index e) {
          return kernel_ && kernel_->place(e) != kNone;
        })) {
      static_cast<void>(condensed_->stress(body_.scale()));
    }
    for (Index e : elements) {
      if (is_prepared_.empty()) break;
      ++preparation_.destroyed;
      preparation_.predicted += is_prepared_[e];
    }
    body_.destroy(elements);
    if (kernel_) kernel_->destroy(elements);
    if (energy_checks_) {
      for (EnergyCheck& check : energy_checks_->all()) check.event();
    }
    route_->destroy(elements);
  }

  void do_exclude_candidates(std::span<const Index> elements) override {
    for (Index e : elements) excluded_[e] = 1;
  }

  void do_solve_pristine(const Load& load, std::span<double> displacement) override {
    pristine_force_.setZero(problem().dof_count());
    for (std::size_t i = 0; i < load.forces.size(); ++i) {
      pristine_force_[load.force_dofs[i]] = load.forces[i];
    }
    intact_.solve(pristine_force_, load.displacements, pristine_u_);
    fem::scatter(problem(), {pristine_u_.data(), static_cast<std::size_t>(pristine_u_.size())},
                 displacement);
  }

  void do_read_displacement(std::span<double> displacement) const override {
    if (condensed_) condensed_->complete(nodal_);
    std::copy(nodal_.begin(), nodal_.end(), displacement.begin());
  }

  void do_read_displacement(std::span<const Index> nodes,
                            std::span<Vec3> displacement) const override {
    if (condensed_ && !std::ranges::all_of(
                          nodes, [this](Index n) { return condensed_->region().inside[n] != 0; })) {
      condensed_->complete(nodal_);
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      displacement[i] = Vec3(&nodal_[3 * static_cast<std::size_t>(nodes[i])]);
    }
  }

  void do_read_stress(std::span<Voigt> stress) const override {
    if (!condensed_) {
      std::copy(stress_.begin(), stress_.end(), stress.begin());
      return;
    }
    const auto whole = condensed_->stress(body_.scale());
    std::copy(whole.begin(), whole.end(), stress.begin());
    const auto& elements = condensed_->region().elements;
    for (std::size_t i = 0; i < elements.size(); ++i) stress[elements[i]] = stress_[i];
  }

  Voigt do_read_stress(Index element) const override {
    if (!condensed_) return stress_[element];
    const Index place = kernel_ ? kernel_->place(element) : kNone;
    return place != kNone ? stress_[place] : condensed_->stress(body_.scale())[element];
  }

  void do_read_reactions(std::span<double> reactions) const override {
    std::copy(reactions_.begin(), reactions_.end(), reactions.begin());
  }

  ChosenRoute chosen_;
  DamagedBody body_;
  IntactBody intact_;
  std::unique_ptr<InverseRoute> route_;
  Load load_;
  Eigen::VectorXd force_, u_, du_, product_, r_;
  Eigen::VectorXd pristine_force_, pristine_u_;  // of the intact body
  double free_residual_ = 0;                     // |r_|
  double unrefined_ = 0;  // error of the last full check's solution before it was refined
  std::optional<engine::InstrumentBlock> instruments_;
  double waited_ms_ = 0;         // for rebases, as reported so far
  std::vector<double> anchors_;  // stiffness of each gripped unknown's anchor
  std::vector<double> reactions_;
  mutable std::vector<double> nodal_;  // published; outside a condensed region only once read
  std::vector<double> next_nodal_;     // of a solution not yet vouched for
  std::vector<double> nodal_forces_;   // K u; also the nodes of du
  mutable std::optional<CondensedFields> condensed_;  // computes what is read
  bool stressed_ = false;
  std::optional<engine::StressKernel> kernel_;
  std::optional<RecentChecks<FrameCheck>> checks_;  // of a deferred update that knows u everywhere
  std::optional<RecentChecks<EnergyCheck>> energy_checks_;  // of a condensed one
  FrameCheck* check_ = nullptr;                             // of the load in work, of checks_
  std::vector<Voigt> stress_, next_stress_;                 // published; of the last solution
  bool fresh_ = false;                                      // next_stress_ is to be published
  double largest_ = 0;                                      // stress of the last solution
  std::vector<std::uint8_t> excluded_;
  PreparationReport preparation_;
  std::vector<std::uint8_t> is_prepared_;  // per element; empty: nothing ever was
  std::vector<Index> prepared_;
};

}  // namespace

DeviceInfo device() {
  DeviceInfo info;
  info.backend = "cpu";
  info.name = cpu_name();
  info.driver = eigen_version();
  info.precisions = "fp64";
  info.limits = std::to_string(available_memory() / 1000000) +
                " MB free memory, routes inverse, condensed, factor, cg";
  info.chosen = true;
  info.why = "always available";
  return info;
}

std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs) {
  if (!problem) throw UsageError("a backend needs a problem");
  ChosenRoute chosen = choose_route(*problem, needs);
  return std::make_unique<CpuBackend>(std::move(problem), std::move(needs), std::move(chosen));
}

}  // namespace sunder::cpu_reference
