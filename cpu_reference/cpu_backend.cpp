// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "cpu_reference/choose_route.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "cpu_reference/routes.hpp"
#include "cpu_reference/stress.hpp"
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
    force_.setZero(n);
    u_.setZero(n);
    reactions_.assign(problem->gripped_dofs().size(), 0.0);
    nodal_.assign(problem->dofs().size(), 0.0);
    if (this->needs().stress) stress_.assign(problem->mesh().tets.size(), Voigt::Zero());
    if (this->needs().yield) excluded_.assign(problem->mesh().tets.size(), 0);
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
                    bytes(nodal_) * 3 + 2 * sizeof(double) * static_cast<std::size_t>(u_.size())});
    if (!stress_.empty()) plan.push_back({"element stress", bytes(stress_)});
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

  SolveReport do_solve() override {
    SolveReport report;
    refine(*route_, report);
    if (!(report.error <= tolerance())) polish(report);
    if (!(report.error <= tolerance())) fail(report);
    fem::scatter(problem(), {u_.data(), static_cast<std::size_t>(u_.size())}, nodal_);
    return report;
  }

  /// Solves by a route and corrects the solution until the estimate is rounding's.
  void refine(InverseRoute& route, SolveReport& report) {
    report.iterations += route.solve(load_, force_, u_).iterations;
    report.error = std::numeric_limits<double>::infinity();
    for (int attempt = 0;; ++attempt) {
      const double error = correction(route, report);
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
    element_stress(problem(), body_.scale(), nodal_, stress_);
    if (!needs().yield) return {};
    return summarize(problem(), body_.destroyed(), excluded_, stress_);
  }

  void do_destroy(std::span<const Index> elements) override {
    body_.destroy(elements);
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
  std::vector<double> reactions_, nodal_;
  std::vector<Voigt> stress_;
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
