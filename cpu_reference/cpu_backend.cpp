// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

#include "cpu_reference/choose_route.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "cpu_reference/frame_check.hpp"
#include "cpu_reference/routes.hpp"
#include "engine/stress_kernel.hpp"
#include "sunder/error.hpp"

namespace sunder::cpu_reference {
namespace {

// The yardstick refines silently down to this stress error, a tenth of what double precision
// promises for an intact body; only frames over the scene's tolerance count as polished.
constexpr double kReferenceError = 1e-10;
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
        intact_(*problem) {
    const auto n = problem->dof_count();
    route_ = make_route();
    if (route_->deferred()) check_.emplace(*problem);
    force_.setZero(n);
    u_.setZero(n);
    reactions_.assign(problem->gripped_dofs().size(), 0.0);
    anchors_.assign(reactions_.size(), 0.0);
    for (Index d : problem->anchored_dofs()) {
      const auto gripped = problem->gripped_dofs();
      const auto g = std::lower_bound(gripped.begin(), gripped.end(), d) - gripped.begin();
      anchors_[static_cast<std::size_t>(g)] = problem->anchor_stiffness();
    }
    if (check_ && !anchors_.empty()) {
      instruments_ = std::make_shared<InstrumentForces>(anchors_);
      grip_forces_.setZero(static_cast<Eigen::Index>(anchors_.size()));
    }
    nodal_.assign(problem->dofs().size(), 0.0);
    next_nodal_ = nodal_;
    if (this->needs().stress || this->needs().damage)
      kernel_.emplace(problem, std::vector<Index>{}, 0);
    if (this->needs().stress) {
      stress_.assign(problem->mesh().tets.size(), Voigt::Zero());
      next_stress_ = stress_;
    }
    if (this->needs().yield) {
      excluded_.assign(problem->mesh().tets.size(), 0);
      kernel_->keep_bounds();
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
    return plan;
  }

 private:
  std::unique_ptr<InverseRoute> make_route() const {
    if (chosen_.route == Route::cg) return conjugate_gradient_route(body_, intact_);
    if (chosen_.update == Update::eager) return dense_inverse_route(body_, intact_);
    return deferred_route(body_, intact_, chosen_.route == Route::inverse);
  }

  void do_set_load(const Load& load) override {
    load_ = load;
    force_.setZero();
    for (std::size_t i = 0; i < load.forces.size(); ++i)
      force_[load.force_dofs[i]] = load.forces[i];
  }

  std::shared_ptr<InstrumentForces> instrument_forces() override { return instruments_; }

  SolveReport do_solve() override {
    SolveReport report = solve_and_check();
    report.waited_ms = route_->waited_ms() - waited_ms_;
    waited_ms_ = route_->waited_ms();
    if (instruments_) publish_instruments();
    return report;
  }

  void publish_instruments() {
    const auto gripped = problem().gripped_dofs();
    for (std::size_t g = 0; g < gripped.size(); ++g) {  // anchors pull as well
      grip_forces_[static_cast<Eigen::Index>(g)] =
          reactions_[g] + anchors_[g] * load_.displacements[g];
    }
    const engine::Deferred& deferred = *route_->deferred();
    deferred.free_grips(grip_forces_, load_.displacements, free_grips_);
    instruments_->publish(deferred.grip_factor(), free_grips_);
  }

  SolveReport solve_and_check() {
    fresh_ = false;
    if (const auto known = solve_cheaply()) {
      nodal_.swap(next_nodal_);
      return *known;
    }
    if (check_) route_->set_enough(0);
    const SolveReport report = solve_checked();
    hand_out();
    nodal_.swap(next_nodal_);
    if (check_)
      check_->checked(load_, report, unrefined_, route_->bases(), largest_u(nodal_), largest_);
    return report;
  }

  /// The solution without a full check, where one like it has had its check.
  std::optional<SolveReport> solve_cheaply() {
    if (!check_) return std::nullopt;
    const auto scale = check_->scale_of(load_, *route_);
    if (!scale) return std::nullopt;
    route_->set_enough(check_->enough(*scale));
    route_->solve(load_, force_, u_);
    hand_out();
    const auto gripped = problem().gripped_dofs();
    for (std::size_t g = 0; g < gripped.size(); ++g) {
      reactions_[g] = route_->deferred()->grip_forces()[static_cast<Eigen::Index>(g)] -
                      anchors_[g] * u_[gripped[g]];  // the anchor's share
    }
    return check_->known(*scale, *route_, largest_u(next_nodal_), largest_);
  }

  static double largest_u(std::span<const double> u) {
    double largest = 0;
    for (double v : u) largest = std::max(largest, std::abs(v));
    return largest;
  }

  /// Displacement at all nodes, and its stress, which do_stress() publishes.
  void hand_out() {
    fem::scatter(problem(), {u_.data(), static_cast<std::size_t>(u_.size())}, next_nodal_);
    if (!kernel_) return;
    largest_ = kernel_->run(next_nodal_, next_stress_);
    fresh_ = true;
  }

  SolveReport solve_checked() {
    SolveReport report;
    refine(*route_, report);
    if (!(report.error <= tolerance())) polish(report);
    if (!(report.error <= tolerance())) fail(report);
    return report;
  }

  /// Solves by a route and corrects the solution until the estimate is rounding's.
  void refine(InverseRoute& route, SolveReport& report) {
    report.iterations += route.solve(load_, force_, u_).iterations;
    report.error = std::numeric_limits<double>::infinity();
    for (int attempt = 0;; ++attempt) {
      const double error = correction(route, report);
      if (attempt == 0) unrefined_ = error;
      if (attempt == 0) report.polished = report.polished || !(error <= tolerance());
      // A correction that no longer shrinks is rounding.
      const bool stalled = attempt > 0 && !(error < report.error / 2);
      report.error = error;
      if (!std::isfinite(error)) return;  // overflow: there is no correction
      const bool enough = error <= kReferenceError && (attempt > 0 || !yardstick());
      if (enough || attempt == kRefinements || stalled) return;
      u_ += du_;
    }
  }

  /// Refinement converges only while the updated inverse is one; once it has drifted too far it is
  /// computed anew, and if that is not enough conjugate gradients on the intact base have the word.
  void polish(SolveReport& report) {
    if (route_->rebase()) refine(*route_, report);
    if (report.error <= tolerance() || chosen_.route == Route::cg) return;
    refine(*conjugate_gradient_route(body_, intact_), report);
  }

  [[noreturn]] void fail(const SolveReport& report) const {
    std::ostringstream message;
    message << "the solution cannot be brought under the tolerance: estimated stress error "
            << report.error << ", residual " << report.residual
            << "; raise solver.tolerance or ease contrast, Poisson's ratio or slivers";
    throw NumericalError(message.str());
  }

  /// du = A^-1 (f - K u), and its stress relative to that of u; sets residual and reactions.
  double correction(InverseRoute& route, SolveReport& report) {
    body_.apply(u_, product_);
    Eigen::VectorXd r = force_ - product_;
    const auto gripped = problem().gripped_dofs();
    double load_norm = force_.squaredNorm();
    for (std::size_t g = 0; g < gripped.size(); ++g) {
      reactions_[g] = -r[gripped[g]];  // what the grip adds to the applied force
      load_norm += reactions_[g] * reactions_[g];
      r[gripped[g]] = 0;
    }
    report.residual = load_norm > 0 ? r.norm() / std::sqrt(load_norm) : 0.0;
    if (!std::isfinite(report.residual)) return report.residual;
    report.iterations += route.apply(r, du_).iterations;
    const double largest = body_.largest_stress(u_);
    const double of_du = body_.largest_stress(du_);
    return of_du == 0 ? 0.0 : of_du / largest;
  }

  /// The plain routes are what others are measured by: they refine once in any case.
  bool yardstick() const { return chosen_.route == Route::cg || chosen_.update == Update::eager; }

  double tolerance() const { return problem().scene().solver.tolerance; }

  StressSummary do_stress() override {
    if (fresh_) std::swap(stress_, next_stress_);
    fresh_ = false;
    if (!needs().yield) return {};
    return kernel_->summarize(excluded_, stress_);
  }

  void do_destroy(std::span<const Index> elements) override {
    body_.destroy(elements);
    kernel_->destroy(elements);
    if (check_) check_->event();
    route_->destroy(elements);
  }

  void do_exclude_candidates(std::span<const Index> elements) override {
    for (Index e : elements) excluded_[e] = 1;
  }

  void do_solve_pristine(const Load& load, std::span<double> displacement) override {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(problem().dof_count()), u;
    for (std::size_t i = 0; i < load.forces.size(); ++i) f[load.force_dofs[i]] = load.forces[i];
    intact_.solve(f, load.displacements, u);
    fem::scatter(problem(), {u.data(), static_cast<std::size_t>(u.size())}, displacement);
  }

  void do_read_displacement(std::span<double> displacement) const override {
    std::copy(nodal_.begin(), nodal_.end(), displacement.begin());
  }

  void do_read_displacement(std::span<const Index> nodes,
                            std::span<Vec3> displacement) const override {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      displacement[i] = Vec3(&nodal_[3 * static_cast<std::size_t>(nodes[i])]);
    }
  }

  void do_read_stress(std::span<Voigt> stress) const override {
    std::copy(stress_.begin(), stress_.end(), stress.begin());
  }

  Voigt do_read_stress(Index element) const override { return stress_[element]; }

  void do_read_reactions(std::span<double> reactions) const override {
    std::copy(reactions_.begin(), reactions_.end(), reactions.begin());
  }

  ChosenRoute chosen_;
  DamagedBody body_;
  IntactBody intact_;
  std::unique_ptr<InverseRoute> route_;
  Load load_;
  Eigen::VectorXd force_, u_, du_, product_;
  std::shared_ptr<InstrumentForces> instruments_;
  Eigen::VectorXd grip_forces_, free_grips_;
  double unrefined_ = 0;         // error of the last full check's solution before it was refined
  double waited_ms_ = 0;         // for rebases, as reported so far
  std::vector<double> anchors_;  // stiffness of each gripped unknown's anchor
  std::vector<double> reactions_, nodal_, next_nodal_;  // next: of a solution not yet vouched for
  std::optional<engine::StressKernel> kernel_;
  std::optional<FrameCheck> check_;
  std::vector<Voigt> stress_, next_stress_;  // published; of the last solution
  bool fresh_ = false;                       // next_stress_ is to be published
  double largest_ = 0;                       // stress of the last solution
  std::vector<std::uint8_t> excluded_;
};

}  // namespace

DeviceInfo device() {
  DeviceInfo info;
  info.backend = "cpu";
  info.name = cpu_name();
  info.driver = eigen_version();
  info.precisions = "fp64";
  info.limits =
      std::to_string(available_memory() / 1000000) + " MB free memory, routes inverse, factor, cg";
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
