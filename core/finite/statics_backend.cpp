// SPDX-License-Identifier: Apache-2.0
#include "finite/statics_backend.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "body/parting.hpp"
#include "solver/finite_statics.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"

namespace sunder::finite {
namespace {

// A tenth of what fp64 promises along a crack (method.md "Accuracy").
constexpr double kLinearTolerance = 1e-9;

solver::FiniteStaticsOptions statics_options(const Problem& problem, bool inverse) {
  solver::FiniteStaticsOptions options;
  options.tolerance = problem.scene().solver.tolerance;
  // Of the linear law a solve is a few back-solves, however far it goes.
  if (!problem.finite()) options.tolerance = std::min(options.tolerance, kLinearTolerance);
  options.turn = problem.finite();
  options.stress = problem.scene().fracture.stress;
  options.inverse = inverse;
  return options;
}

class StaticsBackend final : public LawBackend {
 public:
  StaticsBackend(std::shared_ptr<const Problem> shared, Needs needs, Machine machine)
      : LawBackend(shared, std::move(needs), std::move(machine)), statics_(statics()) {
    if (this->needs().pristine) {
      pristine_.emplace(intact(), statics_options(*shared, by_inverse()), device_of_intact());
    }
    leave_out(
        "remaining share of a destroyed element's stiffness (fracture.alpha): with tangents of the "
        "body as it is, it adds nothing to energy and forces");
    leave_out("preparation of predicted fractures: for updates of one base alone");
  }

  std::vector<KernelPlan> kernels() const override {
    std::vector<KernelPlan> list = LawBackend::kernels();
    if (needs().pristine) {
      list.push_back({"intact body's field", "its own equilibrium, once a step that breaks"});
    }
    return list;
  }

 private:
  Words words() const override {
    return {problem().finite()    ? "a law of finite deformation"
            : problem().fibrous() ? "law linear with fibres"
                                  : "cracks that split",
            "a recent tangent", ", once an iteration of L-BFGS"};
  }
  [[nodiscard]] std::unique_ptr<solver::FiniteStatics> statics() const {
    return std::make_unique<solver::FiniteStatics>(body(), statics_options(problem(), by_inverse()),
                                                   device());
  }
  void leave_device() override {
    statics_->leave_device();
    if (pristine_) pristine_->leave_device();
  }

  SolveReport do_solve() override {
    const auto found = attempt([&] { return statics_->solve(load_); });
    spent_.back_solves += found.back_solves;
    spent_.factors += found.factors;
    new_bases() += found.new_bases;
    SolveReport report;
    report.waited_ms = found.new_bases.waited_ms;
    report.residual = found.residual;
    report.error = found.error;
    report.back_solves = found.back_solves;
    report.unfinished = found.unfinished;
    moved_to(statics_->displacement());  // after a refusal the last state at rest
    const Spent spent = spent_;
    if (!found.unfinished) spent_ = {};
    if (!found.at_rest && !found.unfinished) fail(found.share, spent, "the body");
    const double tolerance = problem().scene().solver.tolerance;
    if (found.at_rest && !(found.error <= tolerance)) {
      throw NumericalError(
          "the body's rest cannot be brought under the tolerance: estimated stress "
          "error " +
          in_digits(found.error) +
          "; raise solver.tolerance or ease contrast, Poisson's ratio or slivers");
    }
    publish_instruments();
    return report;
  }

  /// Since the last rest.
  struct Spent {
    int back_solves = 0, factors = 0;
  };

  [[noreturn]] static void fail(double share, const Spent& spent, const std::string& what) {
    std::ostringstream out;
    out << what << " finds no equilibrium beyond " << 100 * share << " % of this step's load after "
        << spent.back_solves << " iterations and " << spent.factors
        << " factors of its tangent; take smaller steps or a smaller load, or raise "
           "solver.tolerance";
    throw NumericalError(out.str());
  }

  Eigen::MatrixXd grip_stiffness() override { return statics_->grip_stiffness(); }

  [[nodiscard]] const solver::RestingBody& resting() const override { return statics_->resting(); }
  /// A piece that hangs on nothing has no stress to speak of.
  [[nodiscard]] std::span<const std::uint8_t> without_stress() const override {
    return statics_->out();
  }

  void do_destroy(std::span<const Index> elements) override {
    attempt([&] { statics_->destroyed(elements); });
    LawBackend::do_destroy(elements);
  }

  void do_change(const fem::Change&) override {
    const Computed before = part();  // first: it goes last
    auto parted = statics();
    parted->go_on_from(*statics_, fem::Parting(*before.problem, computed()));
    statics_ = std::move(parted);
  }

  void do_grip(const GripChange& change) override {
    const Computed before = take_grips(change.before);  // first: it goes last
    auto gripped = statics();
    gripped->go_on_from(*statics_);
    statics_ = std::move(gripped);
  }

  void do_solve_pristine(const Load& load, std::span<double> displacement) override {
    const auto solve = [&] { return attempt([&] { return pristine_->solve(load); }); };
    solver::FiniteStaticsReport found = solve();
    Spent spent{found.back_solves, found.factors};
    while (found.unfinished) {
      found = solve();
      spent.back_solves += found.back_solves;
      spent.factors += found.factors;
    }
    if (!found.at_rest) fail(found.share, spent, "the intact body");
    std::ranges::copy(pristine_->displacement(), displacement.begin());
  }

  /// What holds the body there: its internal forces less the load.
  void do_read_reactions(std::span<double> reactions) const override {
    Eigen::VectorXd at = Eigen::VectorXd::Zero(computed().dof_count());
    const auto forces = statics_->internal_forces();
    for (std::size_t i = 0; i < forces.size(); ++i) {
      if (computed().dofs()[i] != kNone) at[computed().dofs()[i]] = forces[i];
    }
    for (std::size_t i = 0; i < load_.forces.size(); ++i)
      at[load_.force_dofs[i]] -= load_.forces[i];
    sum_grips(at, reactions);
  }

  std::unique_ptr<solver::FiniteStatics> statics_;
  std::optional<solver::FiniteStatics> pristine_;
  Spent spent_;
};

}  // namespace

std::unique_ptr<Backend> create_statics(std::shared_ptr<const Problem> problem, Needs needs,
                                        Machine machine) {
  return std::make_unique<StaticsBackend>(std::move(problem), std::move(needs), std::move(machine));
}

}  // namespace sunder::finite
