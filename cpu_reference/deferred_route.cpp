// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <optional>

#include "body/stiffness_factor.hpp"
#include "cpu_reference/routes.hpp"
#include "solver/factor_base.hpp"
#include "solver/frame_cost.hpp"
#include "solver/inverse_base.hpp"
#include "solver/renewed_update.hpp"

namespace sunder::cpu_reference {
namespace {

// Columns that a fracture of one element adds to the damage, along a tear.
constexpr double kColumns = 1.75;
constexpr double kFewestColumns = 64;
// The same where an element shares its volume with a patch, whose nodes come with it.
constexpr double kPooledColumns = 8, kFewestPooledColumns = 256;
// A crack that splits patches changes what the border of the new nodes rests on, which costs
// columns times columns times new unknowns: a new base comes soon, and a step waits for it if need
// be.
constexpr double kSplitColumns = 30;
constexpr int kMostSplitFrames = 6;
// Columns beyond those that a base is expected to serve, in fractures of several elements.
constexpr Index kSpare = 64;

class DeferredRoute final : public InverseRoute {
 public:
  DeferredRoute(const DamagedBody& body, IntactBody& intact, bool dense,
                std::chrono::milliseconds rest)
      : dense_(dense),
        all_(static_cast<std::size_t>(body.problem().dof_count())),
        unknowns_(all_.size()),
        factors_(std::move(intact.factors)) {
    std::iota(all_.begin(), all_.end(), 0);
    std::unique_ptr<solver::Base> base;
    if (dense) {
      base = intact.inverse
                 ? std::make_unique<solver::InverseBase>(intact.factor, std::move(intact.inverse))
                 : std::make_unique<solver::InverseBase>(intact.factor);
    } else {
      base = std::make_unique<solver::FactorBase>(intact.factor);
    }
    solver::Based first;
    if (!factors_) {
      first.deferred = std::make_unique<solver::Deferred>(body.problem(), std::move(base), false);
      update_.emplace(body, std::move(first));
      return;
    }
    const bool pools = body.problem().pools() != nullptr;
    const bool splits = pools && body.problem().scene().fracture.crack == CrackWay::split;
    const double each = splits ? kSplitColumns : pools ? kPooledColumns : kColumns;
    const int of_factor = solver::frames_of_a_factor(intact.factor.cholesky(), body.scale().size());
    const int frames = splits ? std::min(of_factor, kMostSplitFrames) : of_factor;
    solver::Renewal renewal;
    renewal.events = frames;
    renewal.rest = rest;
    // As many as have followed a base when it is taken: where frames tear without a pause, the next
    // one begins at once.
    renewal.columns = body.problem().gripped_dofs().size() +
                      static_cast<std::size_t>(
                          std::max(each * frames, pools ? kFewestPooledColumns : kFewestColumns));
    const Index followed = static_cast<Index>(each * frames) + kSpare;
    const Index columns = static_cast<Index>(renewal.columns) + followed;
    // The factor that takes the inverse's place solves backward for as much as so many columns.
    renewal.first_columns =
        dense ? std::max(renewal.columns, intact.factor.entries() / unknowns_) : renewal.columns;
    first.deferred =
        std::make_unique<solver::Deferred>(body.problem(), std::move(base), true,
                                           static_cast<Index>(renewal.first_columns) + followed);
    update_.emplace(body, std::move(first), renewal,
                    [this, columns](const DamagedBody& of, const linear_algebra::FactorWork& work) {
                      return based_on(of, work, columns);
                    });
  }

  Applied solve(const Load& load, const Eigen::VectorXd&, Eigen::VectorXd& u) override {
    update_->loaded(load);
    const solver::Forces forces{load.force_dofs, load.forces};
    if (!split()) {
      update_->deferred().solve(forces, load.displacements, u, energy_tolerance_);
    } else {
      update_->deferred().solve(forces, load.displacements, of_base_, energy_tolerance_);
      add_offsets(u);
    }
    return {};
  }

  Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& u) override {
    const auto size = static_cast<std::size_t>(r.size());
    for (std::size_t i = all_.size(); i < size; ++i) all_.push_back(static_cast<Index>(i));
    if (!split()) {
      update_->deferred().correct({std::span(all_).first(size), {r.data(), size}}, u);
    } else {
      forces_ = r;
      if (update_->parted()) update_->parted()->take_forces(forces_);
      update_->deferred().correct({std::span(all_).first(size), {forces_.data(), size}}, of_base_);
      add_offsets(u);
    }
    return {};
  }

  void follow(const fem::Event& event) override {
    const bool anew =
        event.nodes.empty() && !split() && solver::takes_new_factor(unknowns_, event.leave.size());
    update_->follow(event, anew);
  }
  bool rebase() override { return update_->rebase(); }

  std::unique_ptr<solver::RouteState> state() const override {
    auto state = std::make_unique<State>();
    state->update = update_->state();
    return state;
  }
  bool go_back(const solver::RouteState& state, std::size_t events) override {
    update_->stop(events);
    update_->go_back(dynamic_cast<const State&>(state).update);
    return true;
  }

  // A column of the dense inverse is at hand without.
  bool prepares() const override { return !dense_ || update_->factor(); }
  void prepare(std::span<const Index> elements) override {
    if (prepares()) update_->deferred().prepare(elements);
  }
  double saved_ms() const override { return update_->saved_ms(); }

  const solver::Deferred* deferred() const override { return &update_->deferred(); }
  void set_energy_tolerance(double energy) override { energy_tolerance_ = energy; }
  int bases() const override { return update_->bases(); }
  const solver::BaseCheck& base_check() const override { return update_->base_check(); }
  NewBases new_bases() const override { return update_->new_bases(); }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = update_->deferred().buffers();
    if (update_->factor()) {
      plan.push_back({"damaged factor (sparse Cholesky)", update_->factor()->bytes()});
    }
    if (factors_) plan.push_back({"stiffness in the factor's order", factors_->bytes()});
    return plan;
  }

 private:
  struct State final : solver::RouteState {
    solver::RenewedUpdate::State update;
  };

  /// There are unknowns beyond the mesh's.
  [[nodiscard]] bool split() const {
    return update_->parted() || update_->deferred().offsets().size() > 0;
  }

  /// The solution of the base's unknowns with the offsets of new nodes behind them.
  void add_offsets(Eigen::VectorXd& u) const {
    const Eigen::VectorXd& d = update_->deferred().offsets();
    u.resize(of_base_.size() + d.size());
    u << of_base_, d;
    if (update_->parted()) update_->parted()->give_displacement(u);
  }

  /// A factor of the body and an empty damage over it.
  solver::Based based_on(const DamagedBody& body, const linear_algebra::FactorWork& work,
                         Index columns) {
    solver::Based based;
    if (!body.forms().new_nodes().empty()) {
      based.parted = std::make_shared<fem::PartedBody>(body);
      based.factor = std::make_shared<const linear_algebra::Factor>(
          fem::factor_stiffness(based.parted->body(), work));
    } else {
      based.factor = factors_->of(body, work);
    }
    based.deferred = std::make_unique<solver::Deferred>(
        based.parted ? based.parted->body().forms() : body.forms(),
        std::make_unique<solver::FactorBase>(*based.factor), true, columns);
    // Room for predictions too: the frame that takes the base is to allocate nothing.
    if (body.problem().scene().solver.prepare) based.deferred->prepare({});
    return based;
  }

  bool dense_;              // the first base is an inverse
  std::vector<Index> all_;  // every unknown: the loads of a residual
  std::size_t unknowns_;    // of the mesh
  Eigen::VectorXd of_base_, forces_;
  double energy_tolerance_ = 0;
  std::unique_ptr<fem::BodyFactors> factors_;    // of whoever makes a base
  std::optional<solver::RenewedUpdate> update_;  // last: its thread uses what is above
};

}  // namespace

std::unique_ptr<InverseRoute> deferred_route(const DamagedBody& body, IntactBody& intact,
                                             bool dense, std::chrono::milliseconds rest) {
  return std::make_unique<DeferredRoute>(body, intact, dense, rest);
}

}  // namespace sunder::cpu_reference
