// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/finite_backend.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "body/analysis.hpp"
#include "body/damaged_body.hpp"
#include "body/hyperelastic_pass.hpp"
#include "cpu_reference/available_memory.hpp"
#include "cpu_reference/stress.hpp"
#include "solver/finite_statics.hpp"
#include "solver/plan.hpp"
#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder::cpu_reference {
namespace {

bool by_inverse(const Problem& problem) { return problem.scene().solver.route == Route::inverse; }

/// Of a dense inverse, where the route is that.
std::size_t inverse_bytes(const Problem& problem) {
  const auto unknowns = static_cast<std::size_t>(problem.dof_count());
  return by_inverse(problem) ? unknowns * unknowns * sizeof(double) : 0;
}

solver::FiniteStaticsOptions options_of(const Problem& problem) {
  solver::FiniteStaticsOptions options;
  options.tolerance = problem.scene().solver.tolerance;
  options.stress = problem.scene().fracture.stress;
  options.inverse = by_inverse(problem);
  return options;
}

class FiniteBackend final : public Backend {
 public:
  FiniteBackend(std::shared_ptr<const Problem> shared, Needs needs, std::size_t factor_entries)
      : Backend(shared, std::move(needs)),
        laws_(fem::laws_of(*shared)),
        body_{*shared, laws_, destroyed()},
        statics_(body_, options_of(*shared)),
        pass_(body_),
        factor_entries_(factor_entries),
        u_(shared->dofs().size(), 0.0) {
    const std::size_t elements = shared->mesh().tets.size();
    if (this->needs().stress) stress_.assign(elements, Voigt::Zero());
    if (this->needs().yield) excluded_.assign(elements, 0);
    if (this->needs().pristine) {
      intact_.emplace(fem::HyperelasticBody{*shared, laws_});
      pristine_.emplace(*intact_, options_of(*shared));
    }
    leave_out(
        "remaining share of a destroyed element's stiffness (fracture.alpha): at finite "
        "deformation it adds nothing to energy and forces");
    leave_out("preparation of predicted fractures: for law \"linear\" alone");
    if (!shared->gripped_dofs().empty()) {
      leave_out("forces of the grips between frames: for law \"linear\" alone");
    }
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
    std::vector<BufferPlan> plan{
        {"factor of a recent tangent (sparse Cholesky)", factor_entries_ * sizeof(double)},
        {"displacement and forces", u_.size() * 4 * sizeof(double)}};
    if (by_inverse(problem())) {
      plan.push_back({"dense inverse of it", inverse_bytes(problem())});
    }
    if (pristine_) {
      plan.push_back({"factor of the intact body's tangent", factor_entries_ * sizeof(double)});
    }
    if (needs().stress) plan.push_back({"stress", stress_.size() * sizeof(Voigt)});
    return plan;
  }

  std::vector<KernelPlan> kernels() const override {
    const auto elements = std::to_string(problem().tet_count());
    std::vector<KernelPlan> list{
        {"internal forces", "energy and forces of " + elements + " elements by their laws"},
        {"base",
         (by_inverse(problem()) ? "product with the dense inverse of a recent tangent"
                                : "forward and backward through the factor of a recent tangent, " +
                                      std::to_string(factor_entries_) + " values") +
             std::string(", once an iteration of L-BFGS")},
        {"line search", "on the energy, a pass over the elements for each length that it tries"},
        {"check", "one base application to what is left, and the stress that it would change"}};
    if (needs().damage) {
      list.push_back({"small update", "of the base by the tangents of destroyed elements"});
    }
    if (needs().stress) {
      list.push_back({"stress", elements + " elements, the stress that fracture.stress names"});
    }
    if (needs().yield) list.push_back({"yield summary", "largest ratio, and where"});
    if (needs().pristine) {
      list.push_back({"intact body's field", "its own equilibrium, once a step that breaks"});
    }
    return list;
  }

 private:
  void do_set_load(const Load& load) override { load_ = load; }

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

  StressSummary do_stress() override {
    fem::HyperelasticPass::Wanted wanted;
    wanted.stress = stress_;
    wanted.measure = problem().scene().fracture.stress;
    pass_.run(u_, wanted);
    // A piece that hangs on nothing has no stress to speak of.
    for (Index e = 0; e < problem().tet_count(); ++e) {
      if (statics_.out()[e]) stress_[e].setZero();
    }
    return needs().yield ? summarize(problem(), destroyed(), excluded_, stress_) : StressSummary{};
  }

  Deformation do_deformation() override {
    fem::HyperelasticPass::Wanted wanted;
    wanted.deformation = true;
    return pass_.run(u_, wanted).deformation;
  }

  void do_cut_off(std::span<const Index> elements) override { pass_.cut_off(elements); }

  void do_destroy(std::span<const Index> elements) override {
    statics_.destroyed(elements);
    pass_.destroy(elements);
  }

  void do_exclude_candidates(std::span<const Index> elements) override {
    for (Index e : elements) excluded_[e] = 1;
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

  void do_read_displacement(std::span<double> displacement) const override {
    std::ranges::copy(u_, displacement.begin());
  }
  void do_read_displacement(std::span<const Index> nodes,
                            std::span<Vec3> displacement) const override {
    for (std::size_t i = 0; i < nodes.size(); ++i) displacement[i] = Vec3(&u_[3 * nodes[i]]);
  }
  void do_read_stress(std::span<Voigt> stress) const override {
    std::ranges::copy(stress_, stress.begin());
  }
  Voigt do_read_stress(Index element) const override { return stress_[element]; }

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

  std::vector<const Law*> laws_;
  fem::HyperelasticBody body_;
  solver::FiniteStatics statics_;
  fem::HyperelasticPass pass_;
  std::optional<fem::HyperelasticBody> intact_;
  std::optional<solver::FiniteStatics> pristine_;
  std::size_t factor_entries_ = 0;
  Load load_;
  Spent spent_;
  std::vector<double> u_;  // at rest, or on the way there
  std::vector<Voigt> stress_;
  std::vector<std::uint8_t> excluded_;
};

/// What the options ask for that finite deformation has not.
void check_options(const Problem& problem) {
  const SolverOptions& solver = problem.scene().solver;
  const std::string law = "law " + in_quotes(problem.law());
  const auto refuse = [&](const std::string& what, const std::string& why,
                          const std::string& instead) {
    throw DeviceError(what + " cannot serve " + law + ": " + why + "; use " + instead);
  };
  if (solver.precision == Precision::fp32) {
    refuse("precision fp32", "backend cpu computes in fp64 only", "precision fp64 or auto");
  }
  if (solver.route == Route::cg) {
    refuse("route cg", "its preconditioner is the factor of the intact body at rest",
           "route factor or auto");
  }
  if (solver.route == Route::condensed) {
    refuse("route condensed", "the stiffness outside its region changes with the deformation",
           "route factor or auto");
  }
  if (solver.update == Update::eager) {
    refuse("update eager", "the base is a tangent that later states do not write over",
           "update deferred or auto");
  }
}

}  // namespace

std::unique_ptr<Backend> create_finite(std::shared_ptr<const Problem> problem, Needs needs,
                                       const CpuOptions& options) {
  check_options(*problem);
  const std::size_t free = options.memory > 0 ? options.memory : available_memory();
  const auto analysis = fem::analyse(*problem);
  // The factor, that of a newer base beside it, and the intact body's.
  const std::size_t factors = needs.pristine ? 4 : 2;
  const std::size_t needed =
      factors * (analysis->entries() * sizeof(double) + inverse_bytes(*problem));
  if (needed > free) {
    throw InputError(InputFault::too_large,
                     "the bases of a tangent need " + std::to_string(needed) + " bytes for " +
                         count_of(problem->dof_count(), "unknown") + ", but " +
                         std::to_string(free) + " are free; use a coarser mesh or law \"linear\"");
  }
  return std::make_unique<FiniteBackend>(std::move(problem), std::move(needs), analysis->entries());
}

}  // namespace sunder::cpu_reference
