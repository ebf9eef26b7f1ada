// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "body/assembly.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "cpu_reference/frame_fields.hpp"
#include "cpu_reference/frame_kernels.hpp"
#include "cpu_reference/prepared_bodies.hpp"
#include "cpu_reference/routes.hpp"
#include "finite/law_backend.hpp"
#include "machine/memory.hpp"
#include "solver/condensed_route.hpp"
#include "solver/frame_solver.hpp"
#include "solver/host_frame.hpp"
#include "solver/instrument_block.hpp"
#include "solver/plan.hpp"
#include "sunder/error.hpp"

namespace sunder::cpu_reference {
namespace {

/// What plans are made for.
solver::PlanDevice plan_device(std::size_t memory) {
  solver::PlanDevice device;
  device.backend = "cpu";
  device.routes = {Route::inverse, Route::condensed, Route::factor, Route::cg};
  device.memory = memory;
  return device;
}

/// The factor of the intact body, where it fits the memory; `prepared` may have it, and null not.
std::optional<IntactBody> intact_body(const Problem& problem, const Needs& needs,
                                      solver::Plan& plan, PreparedBody* prepared) {
  const auto analysis = std::move(plan.analysis);
  if (!analysis) return std::nullopt;
  const bool rebases =
      needs.damage && !plan.eager && plan.route != Route::condensed && plan.route != Route::cg;
  std::optional<IntactBody> body(std::in_place, problem, rebases, *analysis,
                                 prepared ? prepared->factor() : factor_of(*analysis));
  if (prepared && plan.route == Route::inverse && !plan.eager) body->inverse = prepared->inverse();
  return body;
}

class CpuBackend final : public Backend {
 public:
  CpuBackend(std::shared_ptr<const Problem> problem, Needs needs, solver::Plan plan,
             std::chrono::milliseconds rest, PreparedBody* prepared)
      : Backend(problem, std::move(needs)),
        plan_(std::move(plan)),
        intact_(intact_body(*problem, this->needs(), plan_, prepared)),
        fields_(damaged_body(), this->needs(), plan_.region),
        route_(make_route(rest)),
        frame_(damaged_body(), *route_, fields_, yardstick(), fall_back()),
        solver_(*problem, frame_) {
    if (this->needs().damage && problem->scene().solver.prepare) reserve_prepared();
    if (this->needs().pristine) {  // so that the first time allocates no more than the next
      pristine_force_.setZero(problem->dof_count());
      if (intact_) pristine_grips_.emplace(damaged_body(), *intact_);
      if (intact_) intact_->solve(pristine_force_, {}, pristine_u_);
    }
    if (route_->deferred() && has_grips()) instruments_.emplace(*problem);
    for (const std::string& what : plan_.left_out) leave_out(what);
  }

  BackendInfo info() const override {
    BackendInfo info = info_of_device();
    info.route = solver::name_of(plan_.route);
    info.update = needs().damage ? solver::name_of_update(plan_) : "none";
    info.why = plan_.why;
    for (const BufferPlan& b : buffers()) info.memory_bytes += b.bytes;
    const solver::FrameCost cost = solver::frame_cost(shape(), {});
    info.quiet_ms = cost.quiet.ms;
    info.fracture_ms = cost.fracture.ms;
    return info;
  }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = route_->buffers();
    if (intact_) plan.push_back({"intact factor (sparse Cholesky)", intact_->factor.bytes()});
    if (intact_ && !intact_->grips.none()) {
      plan.push_back({"compliance columns of grips", intact_->grips.bytes()});
    }
    const auto unknowns = static_cast<std::size_t>(problem().dof_count());
    plan.push_back(
        {"displacement and forces", (problem().dofs().size() * 4 + unknowns * 2) * sizeof(double)});
    for (BufferPlan& b : fields_.buffers()) plan.push_back(std::move(b));
    return plan;
  }

  std::vector<KernelPlan> kernels() const override { return frame_kernels(shape(), needs()); }

 private:
  solver::FrameShape shape() const {
    solver::FrameShape shape = plan_.shape(problem(), needs());
    if (intact_) {
      shape.entries = intact_->factor.entries();
      shape.path = intact_->factor.path_entries(an_element_that_can_break());
      shape.load_path = intact_->factor.path_entries(loaded_by_instruments());
    }
    if (const solver::Deferred* deferred = plan_.region ? route_->deferred() : nullptr) {
      shape.columns = static_cast<std::size_t>(deferred->rank() - deferred->grips());
    }
    shape.stressed = fields_.stressed();
    shape.threads = fields_.threads();
    return shape;
  }

  void add_unknowns(Index node, std::vector<Index>& dofs) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (problem().dof(node, axis) != kNone) dofs.push_back(problem().dof(node, axis));
    }
  }

  /// Where forces act. A press takes its nodes at a crack when the time has come: an element that
  /// can break stands for them.
  std::vector<Index> loaded_by_instruments() const {
    std::vector<Index> dofs;
    for (std::size_t i = 0; i < problem().instrument_nodes().size(); ++i) {
      const auto& action = problem().scene().instruments[i].action;
      if (std::holds_alternative<Press>(action)) {
        const auto crack = an_element_that_can_break();
        dofs.insert(dofs.end(), crack.begin(), crack.end());
      } else if (std::holds_alternative<Pull>(action)) {
        for (Index n : problem().instrument_nodes()[i].nodes) add_unknowns(n, dofs);
      }
    }
    return dofs;
  }

  /// Unknowns of one: the middle one that the scene itself can destroy, or of all.
  std::vector<Index> an_element_that_can_break() const {
    std::vector<Index> all, dofs;
    for (Index e = 0; e < problem().tet_count(); ++e) {
      if (problem().destructible(e)) all.push_back(e);
    }
    const Index e = all.empty() ? problem().tet_count() / 2 : all[all.size() / 2];
    for (Index n : problem().mesh().tets[e]) add_unknowns(n, dofs);
    return dofs;
  }

  std::unique_ptr<InverseRoute> make_route(std::chrono::milliseconds rest) {
    if (!intact_) {
      const auto preconditioner = incomplete_factor(problem());
      if (needs().pristine) never_damaged_.emplace(damaged_body().shared_problem(), preconditioner);
      return incomplete_route(damaged_body(), preconditioner);
    }
    if (plan_.route == Route::cg) return conjugate_gradient_route(damaged_body(), *intact_);
    if (const solver::Region* region = fields_.region()) {
      // Without an owner: the intact body outlives the route.
      return solver::condensed_route(damaged_body(), {std::shared_ptr<void>(), &intact_->factor},
                                     region->dofs, needs().damage, rest);
    }
    if (plan_.eager) return dense_inverse_route(damaged_body(), *intact_);
    fields_.keep_forces();
    return deferred_route(damaged_body(), *intact_, plan_.route == Route::inverse, rest);
  }

  /// The plain routes are what others are measured by.
  [[nodiscard]] bool yardstick() const {
    return (plan_.route == Route::cg && intact_) || (plan_.route == Route::inverse && plan_.eager);
  }

  /// Conjugate gradients on the intact body.
  solver::HostFrame::MakeRoute fall_back() {
    if (plan_.route == Route::cg || !intact_) return {};
    return [this] { return conjugate_gradient_route(damaged_body(), *intact_); };
  }

  /// The solution in work holds.
  void publish() {
    if (fields_.region() && solver_.everywhere()) {
      fields_.publish_everywhere(frame_.u());
      return;
    }
    if (!fields_.region() && !fields_.has_forces()) static_cast<void>(fields_.take(frame_.u()));
    fields_.publish(*route_);
  }

  void do_set_load(const Load& load) override { frame_.set_load(load); }

  NewBases take_new_bases() override {
    const NewBases all = route_->new_bases(), before = std::exchange(taken_, all);
    return {all.count - before.count, all.waited_ms - before.waited_ms};
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
    if (!prepares()) {
      route_->prepare(elements);  // what else it may bring to hand counts nothing
      return;
    }
    const auto start = Clock::now();
    is_prepared_.assign(problem().mesh().tets.size(), 0);
    prepared_.clear();
    reserve_prepared();
    for (Index e : elements) {
      if (destroyed()[e] || is_prepared_[e]) continue;
      is_prepared_[e] = 1;
      prepared_.push_back(e);
    }
    route_->prepare(prepared_);
    preparation_.spent_ms +=
        std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }

  SolveReport do_solve() override {
    const double stress_before = frame_.stress_ms();
    SolveReport report = solver_.solve(frame_.load());
    report.stress_ms = frame_.stress_ms() - stress_before;
    publish();
    const double waited = route_->new_bases().waited_ms;
    report.waited_ms = waited - waited_ms_;
    waited_ms_ = waited;
    if (instruments_) publish_instruments();
    return report;
  }

  void publish_instruments() {
    instruments_->publish(gripped_dofs(), route_->deferred()->grip_factor(), frame_.reactions(),
                          frame_.load().displacements);
  }

  StressSummary do_stress() override { return fields_.publish_stress(); }
  Deformation do_deformation() override { return fields_.deformation(); }
  void do_cut_off(std::span<const Index> elements) override { fields_.cut_off(elements); }

  void do_destroy(std::span<const Index> elements) override {
    fields_.destroy(elements);
    for (Index e : elements) {
      if (is_prepared_.empty()) break;
      ++preparation_.destroyed;
      preparation_.predicted += is_prepared_[e];
    }
    solver_.event();
    route_->follow({.leave = elements});
  }

  struct State final : BackendState {
    FrameFields::State fields;
    solver::HostFrame::State frame;
    std::shared_ptr<const solver::FrameSolver::State> solver;
    std::unique_ptr<solver::RouteState> route;
  };

  std::unique_ptr<BackendState> do_save() const override {
    auto state = std::make_unique<State>();
    state->route = route_->state();
    if (!state->route) return nullptr;
    state->fields = fields_.state();
    state->frame = frame_.state();
    state->solver = solver_.state();
    return state;
  }

  bool do_restore(const BackendState& of, std::size_t events) override {
    const auto& state = dynamic_cast<const State&>(of);
    if (!route_->go_back(*state.route, events)) return false;
    const std::vector<Index> changed = damaged_body().changed(events, damaged_body().events());
    take_body_back(events);
    fields_.restore(state.fields, changed);
    frame_.restore(state.frame);
    solver_.restore(*state.solver);
    if (instruments_ && !state.frame.load.displacements.empty()) publish_instruments();
    return true;
  }

  std::string why_no_grasp() const override {
    if (needs().pristine && !intact_) {
      return "the intact body's field, which the fracture model reads, has no factor here that a "
             "grip could be added to; take route factor on a machine with more memory, or model "
             "\"A\"";
    }
    return {};
  }

  void do_grip(const GripChange& change) override {
    solver_.grips_changed();
    frame_.follow_grips(change.before);
    route_->follow({.grasp = change.grasp, .release = change.release});
  }

  void do_change(const fem::Change& change) override {
    if (!splits()) {
      throw UsageError("route " + solver::name_of(plan_.route) + " takes no new nodes");
    }
    fields_.change(change);
    solver_.event();
    route_->follow(change);
  }

  /// The routes whose deferred update takes new unknowns.
  [[nodiscard]] bool splits() const {
    return !plan_.eager && (plan_.route == Route::inverse || plan_.route == Route::factor);
  }

  void do_exclude_candidates(std::span<const Index> elements) override {
    fields_.exclude_candidates(elements);
  }

  void do_solve_pristine(const Load& load, std::span<double> displacement) override {
    pristine_force_.setZero(problem().dof_count());
    for (std::size_t i = 0; i < load.forces.size(); ++i) {
      pristine_force_[load.force_dofs[i]] = load.forces[i];
    }
    if (intact_) {
      intact_->solve(pristine_force_, pristine_grips_->now(), load.displacements, pristine_u_);
    } else {
      never_damaged_->solve(load, pristine_force_, pristine_u_);
    }
    fem::scatter(problem(), {pristine_u_.data(), static_cast<std::size_t>(pristine_u_.size())},
                 displacement);
  }

  void do_read_displacement(std::span<double> displacement) const override {
    fields_.read_displacement(displacement);
  }
  void do_read_displacement(std::span<const Index> nodes,
                            std::span<Vec3> displacement) const override {
    fields_.read_displacement(nodes, displacement);
  }
  void do_read_stress(std::span<Voigt> stress) const override { fields_.read_stress(stress); }
  Voigt do_read_stress(Index element) const override { return fields_.read_stress(element); }

  void do_read_reactions(std::span<double> reactions) const override {
    std::ranges::copy(frame_.reactions(), reactions.begin());
  }

  solver::Plan plan_;
  std::optional<IntactBody> intact_;           // empty: its factor does not fit the memory
  std::optional<NeverDamaged> never_damaged_;  // in its place, for the pristine field
  FrameFields fields_;
  std::unique_ptr<InverseRoute> route_;
  solver::HostFrame frame_;
  solver::FrameSolver solver_;
  Eigen::VectorXd pristine_force_, pristine_u_;  // of the intact body
  std::optional<PresentGrips> pristine_grips_;
  std::optional<solver::InstrumentBlock> instruments_;
  double waited_ms_ = 0;  // for rebases, as reported so far by solve()
  NewBases taken_;        // by take_new_bases() so far
  PreparationReport preparation_;
  std::vector<std::uint8_t> is_prepared_;  // per element; empty: nothing ever was
  std::vector<Index> prepared_;
};

}  // namespace

std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs) {
  return create(std::move(problem), std::move(needs), CpuOptions{});
}

std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs,
                                const CpuOptions& options) {
  if (!problem) throw UsageError("a backend needs a problem");
  if (problem->scene().solver.device > 0) {
    throw DeviceError("backend cpu has device 0 only, not " +
                      std::to_string(problem->scene().solver.device));
  }
  const std::size_t memory = options.memory > 0 ? options.memory : machine::available_memory();
  if (problem->moves() || problem->finite() || problem->fibrous()) {
    return finite::create(std::move(problem), std::move(needs), {info_of_device(), memory});
  }
  solver::PlanDevice device = plan_device(memory);
  const std::shared_ptr<PreparedBody> prepared =
      options.prepared ? options.prepared->of(problem) : nullptr;
  if (prepared) device.analysis = [&] { return prepared->analysis(); };
  solver::Plan plan = solver::make_plan(*problem, needs, device);
  return std::make_unique<CpuBackend>(std::move(problem), std::move(needs), std::move(plan),
                                      options.rest, prepared.get());
}

}  // namespace sunder::cpu_reference
