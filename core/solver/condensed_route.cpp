// SPDX-License-Identifier: Apache-2.0
#include "solver/condensed_route.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

#include "body/assembly.hpp"
#include "body/body_factors.hpp"
#include "solver/background_rebase.hpp"
#include "solver/condensed_update.hpp"
#include "solver/load_room.hpp"
#include "solver/new_base_timer.hpp"
#include "solver/region_growth.hpp"
#include "solver/whole_solution.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

// Events between the start of a new base and the frame that takes it. For 1,000 unknowns it takes
// 30 to 60 ms: after 64 events frames that follow without a pause waited up to 40 ms (two
// processors shared by four programs), after 96 up to 17; later ones gather more columns. A base
// takes n^2 multiply-adds a column and a frame n, so that more unknowns need more frames: of 3,750
// and 10,000 one waited .4 and .9 s after 234 and 384 events, none after 375 and 512, and the
// median frame took up to a tenth longer.
constexpr Index kFewestEvents = 96, kMostEvents = 512, kSmall = 1000, kUnknownsPerEvent = 8;

Index events_of_a_base(std::size_t dofs) {
  return std::clamp((static_cast<Index>(dofs) - kSmall) / kUnknownsPerEvent, kFewestEvents,
                    kMostEvents);
}

// A new base begins when the damage has so many columns: the small matrices then cost a frame about
// as much as the columns of X_SS.
constexpr std::size_t kFewestColumns = 64, kMostColumns = 256;

// Columns that an event brings: there is room for the damage of large ones (as in deferred.cpp),
// and that of a few elements is touched from the start.
constexpr std::size_t kLargestEvent = 512, kUsualEvent = 32;

// An updated X_SS whose check finds more is computed anew from a factor of the damaged body, which
// takes as long as thousands of frames. energy_check.cpp allows for a growth of 100 up to 1e-8;
// half of that, as the shares of several loads add up. Over 640 fractures of 1,000 unknowns there
// is up to 2e-11 within 30,246 elements and 1e-11 within 119,286, without growth from base to base.
constexpr double kDrift = 5e-11;

// An event of more elements costs more than a factor of the body as it is and X_SS by that: its
// small matrix grows by some four columns an element. 119,286 tetrahedra (ms, inside the region or
// beyond): 1,000 elements 4,500 to 13,000, 2,000 as much as 45,000; X_SS of 1,000 unknowns by a new
// factor 2,000, of 10,000 10,000.
constexpr std::size_t kColumnsByOne = 4, kWide = 2000, kUnknownsPerColumn = 4;

bool is_wide(const fem::Event& event, std::size_t dofs) {
  return kColumnsByOne * event.leave.size() > kWide + dofs / kUnknownsPerColumn;
}

void complete_by(const CondensedBase& base, Equilibrium& whole, WholeRoom& room,
                 Eigen::VectorXd& everywhere, Eigen::VectorXd& u) {
  base.equilibrium(whole);
  solve_whole(whole, room, everywhere);
  for (Index d : base.dofs()) everywhere[d] = u[d];
  u.swap(everywhere);
}

/// The base below a deferred update of this route.
CondensedBase& base_of(const Based& based) {
  return static_cast<CondensedBase&>(based.deferred->base());
}

Based lay_over(const fem::Forms& in_base, std::shared_ptr<const linear_algebra::Factor> factor,
               std::unique_ptr<CondensedBase> base, bool damage) {
  Based based;
  based.factor = std::move(factor);
  const Index columns = columns_of_a_base(base->dofs().size());
  based.deferred = std::make_unique<Deferred>(in_base, std::move(base), damage, columns);
  based.deferred->judge_by_energy();
  return based;
}

/// X_SS by a factor.
Based condensed_by(const fem::Forms& in_base, std::shared_ptr<const linear_algebra::Factor> factor,
                   std::span<const Index> dofs, bool damage,
                   const linear_algebra::FactorWork& work) {
  auto base = std::make_unique<CondensedBase>(factor, dofs, work);
  return lay_over(in_base, std::move(factor), std::move(base), damage);
}

void check_condensed(Based& based, const fem::DamagedBody& body, const Load& load) {
  Equilibrium whole;
  WholeRoom room;
  Eigen::VectorXd everywhere;
  check_base(based, body, load,
             [&](Eigen::VectorXd& u) { complete_by(base_of(based), whole, room, everywhere, u); });
}

/// A check of an updated X_SS by the factor's own: what it lacks, in elements within S. What lies
/// outside follows from the forces on S by that factor, exactly. False: it cannot be had.
bool check_updated(Based& based, const fem::DamagedBody& body, const Load& load,
                   std::span<const Index> elements) {
  if (elements.empty()) return false;
  Eigen::VectorXd u, du;
  based.deferred->solve({load.force_dofs, load.forces}, load.displacements, u);
  const Eigen::VectorXd& lacks = base_of(based).drift();
  du.setZero(u.size());
  const auto dofs = base_of(based).dofs();
  for (std::size_t i = 0; i < dofs.size(); ++i) du[dofs[i]] = lacks[static_cast<Eigen::Index>(i)];
  const double stress = body.largest_stress(du, elements),
               largest = body.largest_stress(u, elements);
  if (!(stress > 0 && stress < largest)) return false;
  based.check = {load, stress / lacks.norm(), stress / largest};
  return true;
}

/// Elements all of whose unknowns are in S.
std::vector<Index> elements_within(const Problem& problem, std::span<const Index> dofs) {
  std::vector<std::uint8_t> inside(static_cast<std::size_t>(problem.dof_count()), 0);
  for (Index d : dofs) inside[d] = 1;
  std::vector<Index> elements;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    bool all = true;
    for (Index n : problem.mesh().tets[e]) {
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = problem.dof(n, axis);
        all = all && (d == kNone || inside[d]);
      }
    }
    if (all) elements.push_back(e);
  }
  return elements;
}

/// The base that comes next: the last one updated, or a new factor where that has drifted or S has
/// grown too large. It has its room from the start, so that beginning one allocates nothing.
class NextBase {
 public:
  /// Over the unknowns `dofs` and what they have grown by, where those are more than `most` by a
  /// factor over `dofs` alone; it begins once the damage has more columns than `threshold`. `dofs`
  /// must outlive it.
  NextBase(const Problem& problem, std::span<const Index> dofs, std::size_t most,
           std::size_t threshold)
      : dofs_(dofs), most_(most), within_(elements_within(problem, dofs)) {
    const std::size_t columns = std::min(dofs.size(), threshold + kLargestEvent);
    state_.reserve(dofs.size(), columns);
    const auto room = static_cast<Eigen::Index>(columns),
               touched = static_cast<Eigen::Index>(std::min(columns, threshold + kUsualEvent));
    for (linear_algebra::RowMajor* a : {&damage_.compliance, &damage_.m, &damage_.d}) {
      a->resize(room, room);
      a->topLeftCorner(touched, touched).setZero();  // so that no frame waits for the memory
    }
  }

  /// Copies what the next base is to be made of; `factored`: events that the factor holds.
  void begin(const Based& last, std::size_t factored) {
    base_of(last).copy_state(state_);
    last.deferred->copy_damage(damage_);
    factored_ = factored;
  }

  /// On another thread; holds nothing of the last base afterwards.
  Based make(const fem::DamagedBody& body, const Load& load, fem::BodyFactors& factors,
             const linear_algebra::FactorWork& work) {
    const struct AtEnd {
      NextBase& next;
      ~AtEnd() { next.release(); }
    } at_end{*this};
    if (state_.dofs.size() <= most_ + body.forms().gripped().size()) {
      state_.settle();
      Based based = updated(body, load, work);
      if (!check_updated(based, body, load, within_)) check_condensed(based, body, load);
      if (based.check.error <= kDrift) return based;
    }
    state_.release();
    Based based = condensed_by(body.forms(), factors.of(body, work), dofs_, true, work);
    check_condensed(based, body, load);
    return based;
  }
  void release() { state_.release(); }

  [[nodiscard]] std::size_t bytes() const {
    return sizeof(double) * static_cast<std::size_t>(damage_.compliance.size() + damage_.m.size() +
                                                     damage_.d.size());
  }

 private:
  Based updated(const fem::DamagedBody& body, const Load& load,
                const linear_algebra::FactorWork& work) const {
    return lay_over(body.forms(), state_.factor,
                    std::make_unique<CondensedBase>(
                        state_, updated_inverse(state_, damage_, load.force_dofs, work),
                        std::make_shared<const LostStiffness>(body, factored_)),
                    true);
  }

  std::span<const Index> dofs_;
  std::size_t most_;
  CondensedState state_;
  DamageMatrices damage_;
  std::size_t factored_ = 0;   // events of the body that the factor holds
  std::vector<Index> within_;  // elements within S
};

/// Deferred update over X_SS.
class CondensedRoute final : public InverseRoute {
 public:
  CondensedRoute(const fem::DamagedBody& body, std::shared_ptr<const linear_algebra::Factor> intact,
                 std::span<const Index> dofs, bool damage, std::chrono::milliseconds rest,
                 RegionProduct* product, DamageSolver* solver, std::size_t most)
      : body_(body),
        dofs_(dofs.begin(), dofs.end()),
        all_(dof_count()),
        product_(product),
        solver_(solver) {
    std::iota(all_.begin(), all_.end(), 0);
    based_ = condensed_by(body.forms(), std::move(intact), dofs_, damage,
                          linear_algebra::work_at_once());
    if (damage) growth_.emplace(body.problem());
    lend();
    intact_ = based_.factor.get();
    make_room(body.problem());
    if (!damage) return;
    factors_.emplace(body.problem(), based_.factor->cholesky().shared_supernodes());
    next_.emplace(body.problem(), dofs_, most, threshold());
    coming_.emplace(body, static_cast<int>(events_of_a_base(dofs_.size())), rest);
  }

  Applied solve(const Load& load, const Eigen::VectorXd&, Eigen::VectorXd& u) override {
    load_ = load;
    based_.laid_over().solve({load.force_dofs, load.forces}, load.displacements, u,
                             energy_tolerance_);
    return {};
  }

  Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& u) override {
    based_.laid_over().solve({all_, {r.data(), static_cast<std::size_t>(r.size())}}, {}, u);
    complete(u);
    return {};
  }

  void complete(Eigen::VectorXd& u) override {
    complete_by(base_of(based_), whole_, room_, everywhere_, u);
  }

  std::span<const Index> known() const override { return base_of(based_).dofs(); }
  int factor() const override { return factor_number_; }
  bool drifts() const override { return based_.deferred && base_of(based_).drifts(); }

  /// Beyond the region nobody looks at stress.
  bool refines() const override {
    return based_.laid_over().offsets().size() == 0 &&
           base_of(based_).dofs().size() == dofs_.size();
  }

  bool refine(const Load& load, Eigen::VectorXd& u, Eigen::VectorXd& added) override {
    if (!refines()) return false;
    CondensedBase& base = base_of(based_);
    Deferred& deferred = based_.laid_over();
    before_ = base.on_region();
    base.expand_mended(deferred.refine_at(base.project_mended(), load.displacements), u);
    deferred.hold(load.displacements, u);
    for (std::size_t i = 0; i < dofs_.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      added[dofs_[i]] = base.on_region()[at] - before_[at];
    }
    return true;
  }

  bool equilibrium(Equilibrium& of) const override {
    base_of(based_).equilibrium(of);
    return true;
  }

  void follow(const fem::Event& event) override {
    const bool wide = is_wide(event, dofs_.size());
    if (!wide && coming_->due()) take_base();
    coming_->follow();
    const bool followed = !wide && based_.laid_over().follow(event);
    if (followed) strayed_ = strayed_ || base_of(based_).dofs().size() > size_;
    if (!followed) {
      rebase();
    } else if (event.of_grips()) {
      based_.check = {};  // it was of loads by other grips
    } else if (begins()) {
      started_ = body_.events();
      start_load_ = load_;
      next_->begin(based_, factored_);
      coming_->start(load_, make_next());
    }
    if (strayed_) prepare_around(event);
  }

  void prepare(std::span<const Index> elements) override {
    named_.assign(elements.begin(), elements.end());
    prepare_named();
  }

  std::unique_ptr<RouteState> state() const override {
    auto state = std::make_unique<State>();
    state->based = based_;
    state->factored = factored_;
    state->bases = bases_;
    state->factor = factor_number_;
    state->laid = based_.laid_over().events();
    state->loaded = load_;
    if (!coming_ || !coming_->making()) return state;
    state->making = true;
    state->start = started_;
    state->load = start_load_;
    return state;
  }

  bool go_back(const RouteState& of, std::size_t events) override {
    const auto& state = dynamic_cast<const State&>(of);
    if (coming_) {
      coming_->give_up();  // what makes it reads next_
      next_->release();
      coming_->go_back(events);
    }
    based_ = state.based;
    lend();
    factored_ = state.factored;
    bases_ = state.bases;
    factor_number_ = state.factor;
    based_.laid_over().take_back(based_.laid_over().events() - state.laid);
    load_ = state.loaded;
    if (state.making) make_again(state, events);
    return true;
  }

  bool rebase() override {
    if (!coming_) return false;
    body_.refuse_new_unknowns();
    const NewBaseTimer timer(new_bases_);
    coming_->give_up();
    next_->release();
    if (growth_) growth_->forget();
    based_ = {};  // frees the old base first
    const linear_algebra::FactorWork work = linear_algebra::work_at_once();
    based_ = condensed_by(body_.forms(), factors_->of(body_, work), dofs_, true, work);
    lend();
    factored_ = body_.events();
    ++bases_;
    ++factor_number_;
    prepare_named();
    return true;
  }

  const Deferred* deferred() const override { return based_.deferred.get(); }
  void set_energy_tolerance(double energy) override { energy_tolerance_ = energy; }
  int bases() const override { return bases_; }
  const BaseCheck& base_check() const override { return based_.check; }
  NewBases new_bases() const override {
    NewBases all = new_bases_;
    if (coming_) all.waited_ms += coming_->waited_ms();
    return all;
  }

  std::vector<BufferPlan> buffers() const override {
    std::vector<BufferPlan> plan = based_.laid_over().buffers();
    if (based_.factor.get() != intact_) {
      plan.push_back({"damaged factor (sparse Cholesky)", based_.factor->bytes()});
    }
    if (next_) plan.push_back({"damage that the next base takes over", next_->bytes()});
    if (factors_ && factors_->bytes() > 0) {
      plan.push_back({"stiffness in the factor's order", factors_->bytes()});
    }
    if (growth_ && growth_->bytes() > 0) {
      plan.push_back({"columns that the region may grow by", growth_->bytes()});
    }
    plan.push_back(
        {"room of full checks", whole_.bytes() + room_.bytes() +
                                    static_cast<std::size_t>(everywhere_.size()) * sizeof(double)});
    return plan;
  }

 private:
  struct State final : RouteState {
    Based based;  // held on to: its memory with it
    std::size_t factored = 0;
    int bases = 1, factor = 1;
    Index laid = 0;  // events over the base
    bool making = false;
    std::size_t start = 0;  // events before the base that was being made
    Load load;              // by which that was checked
    Load loaded;
  };

  [[nodiscard]] MakeBase make_next() {
    return [this](const fem::DamagedBody& body, const Load& load,
                  const linear_algebra::FactorWork& work) {
      return next_->make(body, load, *factors_, work);
    };
  }

  /// The base that was being made begins from the damage that there was when it was begun.
  void make_again(const State& state, std::size_t events) {
    Deferred& deferred = based_.laid_over();
    deferred.take_back(static_cast<Index>(events - state.start));
    started_ = state.start;
    start_load_ = state.load;
    next_->begin(based_, factored_);
    fem::Change event;
    for (std::size_t i = state.start; i < events; ++i) {
      body_.read(i, event);
      if (!deferred.follow(event)) throw NumericalError("an event cannot be followed again");
    }
    coming_->start_again(state.start, state.load, make_next());
  }

  [[nodiscard]] std::size_t dof_count() const {
    return static_cast<std::size_t>(body_.problem().dof_count());
  }

  /// So that frames allocate nothing, a full check among them.
  void make_room(const Problem& problem) {
    reserve(load_, problem);
    reserve(start_load_, problem);
    whole_.reserve(all_.size(), dofs_.size());
    room_.reserve(problem.dof_count(), dofs_.size());
    everywhere_.resize(problem.dof_count());
    before_ = base_of(based_).on_region();
  }

  std::size_t threshold() const {
    return body_.problem().gripped_dofs().size() +
           std::clamp(dofs_.size() / 8, kFewestColumns, kMostColumns);
  }

  bool begins() const {
    const Deferred& deferred = based_.laid_over();
    // A base has unit vectors of all that is gripped; the load is the last frame's.
    const auto grasped =
        static_cast<std::size_t>(deferred.grips()) - body_.forms().own_gripped().size();
    const bool fits = load_.displacements.empty() ||
                      load_.displacements.size() == static_cast<std::size_t>(deferred.grips());
    return !coming_->making() && fits &&
           static_cast<std::size_t>(deferred.rank()) > threshold() + grasped &&
           body_.forms().new_nodes().empty();
  }

  /// What the present base works with besides itself.
  void lend() {
    CondensedBase& base = base_of(based_);
    base.multiply_by(product_);
    base.grow_by(growth_ ? &*growth_ : nullptr);
    if (solver_) based_.deferred->solve_by(solver_);
    size_ = base.dofs().size();
  }

  /// Once S has grown, what lies around events is likely to come next.
  void prepare_around(const fem::Event& event) {
    touched_.assign(event.grasp.begin(), event.grasp.end());
    for (Index e : event.leave) touch(e);
    for (const fem::Coming& c : event.come) touch(c.element);
    look_around();
  }

  /// What a host has named, by the factor that there is.
  void prepare_named() {
    if (!growth_ || !based_.deferred || named_.empty()) return;
    touched_.clear();
    for (Index e : named_) touch(e);
    if (!base_of(based_).inside(touched_)) look_around();
  }

  /// A thread computes what S may grow by around touched_.
  void look_around() {
    const CondensedBase& base = base_of(based_);
    growth_->follow(base.factor(), base.dofs(), touched_);
  }

  /// An element's unknowns, where it is one of the mesh's.
  void touch(Index element) {
    const Problem& problem = body_.problem();
    if (element >= problem.tet_count()) return;
    for (Index n : problem.mesh().tets[static_cast<std::size_t>(element)]) {
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = problem.dof(n, axis);
        if (d != kNone) touched_.push_back(d);
      }
    }
  }

  void take_base() {
    const auto factor = based_.factor;
    if (!coming_->take(based_)) return;  // what there is still holds; the next event tries again
    lend();
    if (based_.factor != factor) {
      factored_ = started_;
      ++factor_number_;
      growth_->forget();
      prepare_named();
    }
    ++bases_;
    ++new_bases_.count;
  }

  const fem::DamagedBody& body_;
  std::vector<Index> dofs_, all_;  // S at first; every unknown: the loads of a residual
  RegionProduct* product_;
  DamageSolver* solver_;
  const linear_algebra::Factor* intact_ = nullptr;
  Load load_;                           // of the last solution
  Load start_load_;                     // of the one before coming_ started
  std::optional<RegionGrowth> growth_;  // where something can be destroyed
  Based based_;
  std::size_t factored_ = 0, started_ = 0;  // events in based_.factor; before coming_ started
  Equilibrium whole_;
  WholeRoom room_;
  Eigen::VectorXd everywhere_;
  Eigen::VectorXd before_;  // a solution on S that is refined
  double energy_tolerance_ = 0;
  int bases_ = 1, factor_number_ = 1;
  NewBases new_bases_;
  // Where something can be destroyed.
  std::size_t size_ = 0;        // of S when the base came
  bool strayed_ = false;        // S has grown some time
  std::vector<Index> touched_;  // unknowns of an event
  std::vector<Index> named_;    // elements that a host may destroy next
  std::optional<fem::BodyFactors> factors_;
  std::optional<NextBase> next_;
  std::optional<BackgroundRebase> coming_;  // last: its thread uses what is above
};

}  // namespace

std::size_t most_unknowns(std::size_t dofs) { return dofs + dofs / 4 + 2048; }

// Fractures of some elements among them.
Index columns_of_a_base(std::size_t dofs) {
  return static_cast<Index>(kMostColumns) + 2 * events_of_a_base(dofs);
}

std::unique_ptr<InverseRoute> condensed_route(const fem::DamagedBody& body,
                                              std::shared_ptr<const linear_algebra::Factor> intact,
                                              std::span<const Index> dofs, bool damage,
                                              std::chrono::milliseconds rest,
                                              RegionProduct* product, DamageSolver* solver,
                                              std::optional<std::size_t> most) {
  return std::make_unique<CondensedRoute>(body, std::move(intact), dofs, damage, rest, product,
                                          solver, most.value_or(most_unknowns(dofs.size())));
}

}  // namespace sunder::solver
