// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/finite_backend.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "cpu_reference/law_backend.hpp"
#include "solver/finite_statics.hpp"
#include "solver/plan.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"

namespace sunder::cpu_reference {
namespace {

solver::FiniteStaticsOptions statics_options(const Problem& problem) {
  solver::FiniteStaticsOptions options;
  options.tolerance = problem.scene().solver.tolerance;
  options.stress = problem.scene().fracture.stress;
  options.inverse = by_inverse(problem);
  return options;
}

class FiniteBackend final : public LawBackend {
 public:
  FiniteBackend(std::shared_ptr<const Problem> shared, Needs needs, std::size_t factor_entries)
      : LawBackend(shared, std::move(needs)),
        statics_(body(), statics_options(*shared)),
        factor_entries_(factor_entries) {
    if (this->needs().pristine) pristine_.emplace(intact(), statics_options(*shared));
    leave_out(
        "remaining share of a destroyed element's stiffness (fracture.alpha): at finite "
        "deformation it adds nothing to energy and forces");
    leave_out("preparation of predicted fractures: for law \"linear\" alone");
  }

  BackendInfo info() const override {
    BackendInfo info = info_of_device();
    info.route = solver::name_of(by_inverse(problem()) ? Route::inverse : Route::factor);
    info.update = needs().damage ? "deferred" : "none";
    info.why = std::string("a law of finite deformation, which backend cpu computes: by the ") +
               (by_inverse(problem()) ? "dense inverse" : "factor") + " of a recent tangent";
    for (const BufferPlan& b : buffers()) info.memory_bytes += b.bytes;
    return info;
  }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = field_buffers();
    plan.insert(plan.begin(),
                {"factor of a recent tangent (sparse Cholesky)", factor_entries_ * sizeof(double)});
    if (pristine_) {
      plan.push_back({"factor of the intact body's tangent", factor_entries_ * sizeof(double)});
    }
    return plan;
  }

  std::vector<KernelPlan> kernels() const override {
    std::vector<KernelPlan> list = field_kernels();
    list.insert(list.begin() + 1,
                {"base", (by_inverse(problem())
                              ? "product with the dense inverse of a recent tangent"
                              : "forward and backward through the factor of a recent tangent, " +
                                    std::to_string(factor_entries_) + " values") +
                             std::string(", once an iteration of L-BFGS")});
    if (needs().pristine) {
      list.push_back({"intact body's field", "its own equilibrium, once a step that breaks"});
    }
    return list;
  }

 private:
  SolveReport do_solve() override {
    const solver::FiniteStaticsReport found = statics_.solve(load_);
    spent_.back_solves += found.back_solves;
    spent_.factors += found.factors;
    SolveReport report;
    report.residual = found.residual;
    report.error = found.error;
    report.back_solves = found.back_solves;
    report.unfinished = found.unfinished;
    u_ = statics_.displacement();  // after a refusal the last state at rest
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

  Eigen::MatrixXd grip_compliance() override { return statics_.grip_compliance(); }

  /// A piece that hangs on nothing has no stress to speak of.
  [[nodiscard]] std::span<const std::uint8_t> without_stress() const override {
    return statics_.out();
  }

  void do_destroy(std::span<const Index> elements) override {
    statics_.destroyed(elements);
    LawBackend::do_destroy(elements);
  }

  void do_solve_pristine(const Load& load, std::span<double> displacement) override {
    solver::FiniteStaticsReport found = pristine_->solve(load);
    Spent spent{found.back_solves, found.factors};
    while (found.unfinished) {
      found = pristine_->solve(load);
      spent.back_solves += found.back_solves;
      spent.factors += found.factors;
    }
    if (!found.at_rest) fail(found.share, spent, "the intact body");
    std::ranges::copy(pristine_->displacement(), displacement.begin());
  }

  /// What holds the body there: its internal forces less the load.
  void do_read_reactions(std::span<double> reactions) const override {
    const auto gripped = problem().gripped_dofs();
    std::vector<double> at(static_cast<std::size_t>(problem().dof_count()), 0.0);
    const auto forces = statics_.internal_forces();
    for (std::size_t i = 0; i < forces.size(); ++i) {
      if (problem().dofs()[i] != kNone) at[problem().dofs()[i]] = forces[i];
    }
    for (std::size_t i = 0; i < load_.forces.size(); ++i)
      at[load_.force_dofs[i]] -= load_.forces[i];
    for (std::size_t g = 0; g < gripped.size(); ++g) reactions[g] = at[gripped[g]];
  }

  solver::FiniteStatics statics_;
  std::optional<solver::FiniteStatics> pristine_;
  std::size_t factor_entries_ = 0;
  Spent spent_;
};

}  // namespace

std::unique_ptr<Backend> create_finite(std::shared_ptr<const Problem> problem, Needs needs,
                                       const CpuOptions& options) {
  // The factor, that of a newer base beside it, and the intact body's.
  const std::size_t entries = check_law_options(*problem, options, needs.pristine ? 4 : 2);
  return std::make_unique<FiniteBackend>(std::move(problem), std::move(needs), entries);
}

}  // namespace sunder::cpu_reference
