// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/motion_backend.hpp"

#include <algorithm>
#include <optional>

#include "body/lumped_mass.hpp"
#include "cpu_reference/law_backend.hpp"
#include "solver/finite_motion.hpp"
#include "solver/plan.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"

namespace sunder::cpu_reference {
namespace {

solver::FiniteMotionOptions motion_options(const Problem& problem) {
  const Dynamics& dynamics = *problem.scene().dynamics;
  solver::FiniteMotionOptions options;
  options.tolerance = problem.scene().solver.tolerance;
  options.stress = problem.scene().fracture.stress;
  options.damping = dynamics.mass_damping;
  options.viscosity = dynamics.stiffness_damping;
  options.gravity = problem.scene().gravity;
  options.most_iterations = dynamics.max_iterations;
  options.inverse = by_inverse(problem);
  options.turn = problem.finite();
  return options;
}

class MotionBackend final : public LawBackend {
 public:
  MotionBackend(std::shared_ptr<const Problem> shared, Needs needs, std::size_t factor_entries)
      : LawBackend(shared, std::move(needs)),
        mass_(fem::lumped_masses(*shared)),
        motion_(body(), mass_, motion_options(*shared)),
        factor_entries_(factor_entries) {
    if (this->needs().pristine) pristine_.emplace(intact(), mass_, motion_options(*shared));
    leave_out(
        "remaining share of a destroyed element's stiffness (fracture.alpha): in motion pieces "
        "need "
        "none to be held by");
    leave_out("preparation of predicted fractures: for statics by law \"linear\" alone");
    if (shared->scene().dynamics->stiffness_damping == 0) {
      leave_out("viscous forces: dynamics.damping names none by stiffness");
    }
  }

  BackendInfo info() const override {
    BackendInfo info = info_of_device();
    info.route = solver::name_of(by_inverse(problem()) ? Route::inverse : Route::factor);
    info.update = needs().damage ? "deferred" : "none";
    info.why = std::string("motion, which backend cpu computes: by the ") +
               (by_inverse(problem()) ? "dense inverse" : "factor") +
               " of a recent tangent with the step's inertia";
    for (const BufferPlan& b : buffers()) info.memory_bytes += b.bytes;
    return info;
  }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = field_buffers();
    const std::size_t factor = factor_entries_ * sizeof(double);
    plan.insert(plan.begin(),
                {"factor of a recent tangent with inertia (sparse Cholesky)", factor});
    plan.push_back({"masses, velocities and the state before", u_.size() * 5 * sizeof(double)});
    if (pristine_) plan.push_back({"factor of the intact body's tangent with inertia", factor});
    return plan;
  }

  std::vector<KernelPlan> kernels() const override {
    std::vector<KernelPlan> list = field_kernels();
    const std::string cap = std::to_string(problem().scene().dynamics->max_iterations);
    list.insert(list.begin() + 1,
                {"base", (by_inverse(problem())
                              ? "product with the dense inverse of a recent tangent with inertia"
                              : "forward and backward through the factor of a recent tangent with "
                                "inertia, " +
                                    std::to_string(factor_entries_) + " values") +
                             std::string(", once an iteration of L-BFGS") +
                             (cap == "0" ? "" : ", at most " + cap + " a step")});
    list.push_back({"energies and momentum", "of each step: kinetic, elastic, work, what is lost"});
    if (pristine_) {
      list.push_back({"intact body's field", "the intact body moves beside, a step each step"});
    }
    return list;
  }

 private:
  SolveReport do_solve() override {
    throw UsageError("a body in motion has no rest to be solved for: advance it");
  }

  SolveReport do_advance(double dt) override {
    dt_ = dt;
    intact_known_ = false;
    const solver::FiniteMotionReport found = motion_.step(load_, dt);
    if (found.stuck) fail(found, dt);
    u_ = motion_.displacement();
    publish_instruments();
    return {.residual = found.residual,
            .error = found.error,
            .back_solves = found.back_solves,
            .capped = found.capped};
  }

  [[noreturn]] static void fail(const solver::FiniteMotionReport& found, double dt) {
    throw NumericalError("no motion over a step of " + in_digits(dt) + " s is found after " +
                         count_of(found.back_solves, "iteration") + " and " +
                         count_of(found.factors, "factor") +
                         " of its tangent; take shorter steps, move grips less in one, or raise "
                         "solver.tolerance");
  }

  Eigen::MatrixXd grip_compliance() override {
    return motion_.grip_compliance(problem().scene().dynamics->felt_inertia);
  }

  void do_destroy(std::span<const Index> elements) override {
    motion_.destroyed(elements);
    LawBackend::do_destroy(elements);
  }

  /// The intact body, at rest at first as the real one was, goes the same way.
  void do_solve_pristine(const Load& load, std::span<double> displacement) override {
    if (!intact_known_) {
      const solver::FiniteMotionReport found = pristine_->step(load, dt_);
      if (found.stuck) fail(found, dt_);
      intact_known_ = true;
    }
    std::ranges::copy(pristine_->displacement(), displacement.begin());
  }

  MotionState do_motion() const override {
    const solver::FiniteMotionBalance sum = motion_.sum();
    return {.time = motion_.time(),
            .kinetic = motion_.kinetic_energy(),
            .strain_energy = motion_.strain_energy(),
            .work = sum.work - motion_.gravity_energy(),
            .damped = sum.damped,
            .scheme = sum.scheme,
            .broken = sum.broken,
            .unsolved = sum.unsolved,
            .momentum = motion_.momentum(),
            .angular_momentum = motion_.angular_momentum()};
  }

  void do_read_velocity(std::span<double> velocity) const override {
    std::ranges::copy(motion_.velocity(), velocity.begin());
  }

  void do_set_velocity(std::span<const double> velocity) override {
    motion_.set_velocity(velocity);
    if (pristine_) pristine_->set_velocity(velocity);
  }

  void do_read_reactions(std::span<double> reactions) const override {
    const auto gripped = problem().gripped_dofs();
    const Eigen::VectorXd& forces = motion_.grip_forces(problem().scene().dynamics->felt_inertia);
    for (std::size_t g = 0; g < gripped.size(); ++g) reactions[g] = forces[gripped[g]];
  }

  std::vector<double> mass_;  // per node
  solver::FiniteMotion motion_;
  std::optional<solver::FiniteMotion> pristine_;
  std::size_t factor_entries_ = 0;
  double dt_ = 0;              // of the last step
  bool intact_known_ = false;  // the intact body has made it too
};

}  // namespace

std::unique_ptr<Backend> create_motion(std::shared_ptr<const Problem> problem, Needs needs,
                                       const CpuOptions& options) {
  // The factor, that of a newer base beside it, and the intact body's.
  const std::size_t entries = check_law_options(*problem, options, needs.pristine ? 4 : 2);
  return std::make_unique<MotionBackend>(std::move(problem), std::move(needs), entries);
}

}  // namespace sunder::cpu_reference
