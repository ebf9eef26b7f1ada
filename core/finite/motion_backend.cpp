// SPDX-License-Identifier: Apache-2.0
#include "finite/motion_backend.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "body/damaged_body.hpp"
#include "body/lumped_mass.hpp"
#include "body/parting.hpp"
#include "solver/finite_motion.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"

namespace sunder::finite {
namespace {

solver::FiniteMotionOptions motion_options(const Problem& problem, bool inverse) {
  const Dynamics& dynamics = *problem.scene().dynamics;
  solver::FiniteMotionOptions options;
  options.tolerance = problem.scene().solver.tolerance;
  options.stress = problem.scene().fracture.stress;
  options.damping = dynamics.mass_damping;
  options.viscosity = dynamics.stiffness_damping;
  options.gravity = problem.scene().gravity;
  options.most_iterations = dynamics.max_iterations;
  options.inverse = inverse;
  options.turn = problem.finite();
  return options;
}

class MotionBackend final : public LawBackend {
 public:
  MotionBackend(std::shared_ptr<const Problem> shared, Needs needs, Machine machine)
      : LawBackend(shared, std::move(needs), std::move(machine)),
        mass_(fem::lumped_masses(*shared)),
        motion_(motion()) {
    if (this->needs().pristine) {
      pristine_.emplace(intact(), mass_, motion_options(*shared, by_inverse()), device_of_intact());
    }
    leave_out(
        "remaining share of a destroyed element's stiffness (fracture.alpha): in motion pieces "
        "need "
        "none to be held by");
    leave_out("preparation of predicted fractures: for statics by law \"linear\" alone");
    if (shared->scene().dynamics->stiffness_damping == 0) {
      leave_out("viscous forces: dynamics.damping names none by stiffness");
    }
  }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = LawBackend::buffers();
    plan.push_back({"masses, velocities and the state before", u_.size() * 5 * sizeof(double)});
    return plan;
  }

  std::vector<KernelPlan> kernels() const override {
    std::vector<KernelPlan> list = LawBackend::kernels();
    list.push_back({"energies and momentum", "of each step: kinetic, elastic, work, what is lost"});
    if (pristine_) {
      list.push_back({"intact body's field", "the intact body moves beside, a step each step"});
    }
    return list;
  }

 private:
  const solver::RestingBody& resting() const override { return motion_->resting(); }

  Words words() const override {
    const int cap = problem().scene().dynamics->max_iterations;
    return {"motion", "a recent tangent with the step's inertia",
            std::string(", once an iteration of L-BFGS") +
                (cap == 0 ? "" : ", at most " + std::to_string(cap) + " a step")};
  }

  [[nodiscard]] std::unique_ptr<solver::FiniteMotion> motion() const {
    return std::make_unique<solver::FiniteMotion>(
        body(), mass_, motion_options(problem(), by_inverse()), device());
  }
  void remember() {
    if (!device()) return;
    past_ = motion_->past();
    if (pristine_) past_of_intact_ = pristine_->past();
  }
  void leave_device() override {
    motion_->leave_device(past_);
    if (pristine_) pristine_->leave_device(past_of_intact_);
  }

  SolveReport do_solve() override {
    throw UsageError("a body in motion has no rest to be solved for: advance it");
  }

  SolveReport do_advance(double dt) override {
    const bool as_long = std::exchange(dt_, dt) == dt;
    intact_known_ = false;
    remember();
    const auto found = attempt([&] { return motion_->step(load_, dt); });
    new_bases() += found.new_bases;
    if (found.stuck) fail(found, dt);
    if (!found.still) moved_to(motion_->displacement());
    // At rest they stay as they are, once the scheme too is that of the step before.
    if (!(found.still && still_ && as_long)) publish_instruments();
    still_ = found.still && found.second_order;
    return {.residual = found.residual,
            .error = found.error,
            .back_solves = found.back_solves,
            .capped = found.capped,
            .waited_ms = found.new_bases.waited_ms};
  }

  [[noreturn]] static void fail(const solver::FiniteMotionReport& found, double dt) {
    throw NumericalError("no motion over a step of " + in_digits(dt) + " s is found after " +
                         count_of(found.back_solves, "iteration") + " and " +
                         count_of(found.factors, "factor") +
                         " of its tangent; take shorter steps, move grips less in one, or raise "
                         "solver.tolerance");
  }

  Eigen::MatrixXd grip_stiffness() override {
    return motion_->grip_stiffness(problem().scene().dynamics->felt_inertia);
  }

  void do_destroy(std::span<const Index> elements) override {
    remember();
    attempt([&] { motion_->destroyed(elements); });
    LawBackend::do_destroy(elements);
  }

  void do_change(const fem::Change&) override {
    const Computed before = part();  // first: it goes last
    mass_ = fem::lumped_masses(computed());
    auto parted = motion();
    parted->go_on_from(*motion_, fem::Parting(*before.problem, computed()));
    motion_ = std::move(parted);
    still_ = false;
  }

  void do_grip(const GripChange& change) override {
    const Computed before = take_grips(change.before);  // first: it goes last
    auto gripped = motion();
    gripped->go_on_from(*motion_);
    motion_ = std::move(gripped);
    still_ = false;
  }

  /// The intact body, at rest at first as the real one was, goes the same way.
  void do_solve_pristine(const Load& load, std::span<double> displacement) override {
    if (!intact_known_) {
      remember();
      const auto found = attempt([&] { return pristine_->step(load, dt_); });
      if (found.stuck) fail(found, dt_);
      intact_known_ = true;
    }
    std::ranges::copy(pristine_->displacement(), displacement.begin());
  }

  MotionState do_motion() const override {
    const solver::FiniteMotionBalance sum = motion_->sum();
    return {.time = motion_->time(),
            .kinetic = motion_->kinetic_energy(),
            .strain_energy = motion_->strain_energy(),
            .work = sum.work - motion_->gravity_energy(),
            .damped = sum.damped,
            .scheme = sum.scheme,
            .broken = sum.broken,
            .unsolved = sum.unsolved,
            .momentum = motion_->momentum(),
            .angular_momentum = motion_->angular_momentum()};
  }

  void do_read_velocity(std::span<double> velocity) const override {
    std::copy_n(motion_->velocity().begin(), velocity.size(), velocity.begin());
  }

  void do_set_velocity(std::span<const double> velocity) override {
    std::vector<double> all(velocity.begin(), velocity.end());
    for (const fem::NewNode& node : damaged_body().forms().new_nodes()) {
      for (Index axis = 0; axis < 3; ++axis) all.push_back(velocity[3 * node.parent + axis]);
    }
    motion_->set_velocity(all);
    if (pristine_) pristine_->set_velocity(velocity);
  }

  Vec3 do_held_beside() const override {
    Vec3 sum = Vec3::Zero();
    const std::vector<double>& viscous = motion_->viscous_forces();
    for (std::size_t i = 0; i < computed().dofs().size(); ++i) {
      if (computed().dofs()[i] != kNone) continue;
      const auto axis = static_cast<Eigen::Index>(i % 3);
      sum[axis] -= mass_[i / 3] * problem().scene().gravity[axis];
      if (!viscous.empty()) sum[axis] += viscous[i];
    }
    return sum;
  }

  void do_read_reactions(std::span<double> reactions) const override {
    sum_grips(motion_->grip_forces(problem().scene().dynamics->felt_inertia), reactions);
  }

  std::vector<double> mass_;  // per node
  std::unique_ptr<solver::FiniteMotion> motion_;
  std::optional<solver::FiniteMotion> pristine_;
  solver::FiniteMotionPast past_, past_of_intact_;  // before what the device does
  double dt_ = 0;                                   // of the last step
  bool intact_known_ = false;                       // the intact body has made it too
  bool still_ = false;                              // nothing moved in it
};

}  // namespace

std::unique_ptr<Backend> create_motion(std::shared_ptr<const Problem> problem, Needs needs,
                                       Machine machine) {
  return std::make_unique<MotionBackend>(std::move(problem), std::move(needs), std::move(machine));
}

}  // namespace sunder::finite
