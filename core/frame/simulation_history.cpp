// SPDX-License-Identifier: Apache-2.0
// Going back and forth: by the backend's own states where it keeps them, else by doing again what
// was done.
#include <algorithm>
#include <iterator>

#include "body/pieces.hpp"
#include "fracture/averaged_strength.hpp"
#include "fracture/finding.hpp"
#include "frame/action_bytes.hpp"
#include "frame/history.hpp"
#include "sunder/error.hpp"

namespace sunder {
namespace {

/// Actions that both begin with.
std::size_t common(const auto& a, const auto& b) {
  const auto [end, other] = std::ranges::mismatch(a, b);
  return static_cast<std::size_t>(end - a.begin());
}

}  // namespace

void Simulation::require_history() const {
  if (!history_)
    throw UsageError("this simulation keeps no history: have it kept before the first step");
}

void Simulation::keep_history(MakeBackend make, int quick) {
  if (history_) throw UsageError("this simulation keeps a history already");
  if (now_.next_step > 0 || now_.next_event > 0 || now_.solved) {
    throw UsageError("a history begins before the first step");
  }
  if (loads_->next_tool() > static_cast<int>(problem_->scene().instruments.size())) {
    throw UsageError("a history begins before the first grip and the first push of a host");
  }
  for (std::size_t i = 0; i < problem_->scene().instruments.size(); ++i) {
    if (loads_->has_let_go(i)) {
      throw UsageError("a history begins before a grip of the scene lets go");
    }
  }
  if (quick < 0) throw UsageError("the number of quick undos must not be below 0");
  history_ = std::make_unique<History>();
  history_->make = std::move(make);
  history_->quick = static_cast<std::size_t>(quick);
  // What was set before is the beginning: it is done again first. No drive reaches a warm-up.
  if (now_.warm) record({Action::WarmUp{}}, nullptr, 0);
  if (now_.attribute) record({Action::Attribute{true}}, nullptr, 0);
  const Loads::State loads = loads_->state();
  for (std::size_t i = 0; i < loads.driven.size(); ++i) {
    if (loads.driven[i]) record({Action::Drive{i, *loads.driven[i]}}, nullptr, 0);
    if (loads.turned[i]) record({Action::Turn{i, *loads.turned[i]}}, nullptr, 0);
  }
}

int Simulation::undos() const { return history_ ? static_cast<int>(history_->points.size()) : 0; }
int Simulation::redos() const { return history_ ? static_cast<int>(history_->undone_broke) : 0; }

void Simulation::record(Action action, std::shared_ptr<const Kept> before, int events_before) {
  History& h = *history_;
  action.broke = now_.next_event != events_before || action.of_tools();
  if (action.broke) {
    h.points.push_back({h.done.size(), std::move(before), events_before});
    if (h.points.size() > h.quick) h.points[h.points.size() - h.quick - 1].kept.reset();
  }
  if (h.travels) return;  // perform() has it
  h.done.push_back(std::make_shared<const Action>(std::move(action)));
  h.undone.clear();
  h.undone_broke = 0;
}

std::shared_ptr<const Simulation::Kept> Simulation::keep() const {
  auto kept = std::make_shared<Kept>();
  kept->criterion = criterion_->state();
  if (!kept->criterion) return nullptr;
  kept->backend = backend_->save();
  if (!kept->backend) return nullptr;
  kept->loads = loads_->state();
  if (averaged_) kept->averaged = averaged_->excluded();
  kept->now = now_;
  kept->destroyed = destroyed_.size();
  kept->findings = findings_.size();
  return kept;
}

bool Simulation::go_back(const Kept& kept) {
  if (!backend_->restore(*kept.backend)) return false;
  criterion_->restore(*kept.criterion);
  loads_->restore(kept.loads);
  // The backend has published already, by grips that were not those of then.
  describe_grips();
  if (haptics_) haptics_->label(kept.now.next_step - 1);
  if (haptics_ && kept.now.solved) haptics_->publish_again();
  if (averaged_) averaged_->exclude_only(kept.averaged);
  now_ = kept.now;
  destroyed_.erase(destroyed_.begin() + static_cast<std::ptrdiff_t>(kept.destroyed),
                   destroyed_.end());
  findings_.erase(findings_.begin() + static_cast<std::ptrdiff_t>(kept.findings), findings_.end());
  pristine_.clear();
  if (now_.solved) {
    of_loads_.clear();
    loads_->update(now_.scene_time, *criterion_, backend_->destroyed(), of_loads_);
    if (averaged_) static_cast<void>(averaged_->summarize(*backend_));
  }
  loose_->hold(loads_->held_unknowns(), loads_->held_nodes());
  criterion_->hold(loads_->held_unknowns());
  loose_->look(backend_->destroyed(), criterion_->corners(), backend_->node_count());
  ++looks_;
  return true;
}

/// A fresh backend; whoever asked for the forces of the grips is told those of the new one.
void Simulation::begin_anew() {
  if (!history_->make) {
    throw UsageError(
        "going there needs a new backend, and the history was not told how to make one");
  }
  std::unique_ptr<Backend> backend = history_->make();
  if (&backend->problem() != problem_.get()) {
    throw UsageError("the backend was created for another problem");
  }
  // By the laws of finite deformation they cost every frame once somebody has asked.
  constexpr long kOurs = 2;  // the backend's own hold and this one
  std::shared_ptr<InstrumentForces> forces;
  try {
    forces = backend_->instrument_forces();
  } catch (const DeviceLost&) {
    // It has none that anybody has: those were there already.
  }
  if (haptics_ || (forces && forces.use_count() > kOurs)) {
    backend->take_over_instrument_forces(haptics_ ? haptics_ : std::move(forces));
  }
  backend_ = std::move(backend);
  now_ = {};
  destroyed_.clear();
  findings_.clear();
  pristine_.clear();
  set_up();
  looks_ = looks_ > 0 ? looks_ + 1 : 0;
  if (looks_ > 0) loose_->look(backend_->destroyed(), {}, backend_->node_count());
  history_->points.clear();
  history_->done.clear();
}

/// Does again what was done before.
void Simulation::perform(const std::shared_ptr<const Action>& action) {
  History& h = *history_;
  const struct Again {
    History& h;
    bool before;
    ~Again() {
      h.travels = before;
      h.again = nullptr;
    }
  } again{h, h.travels};
  h.travels = true;
  h.again = action.get();
  try {
    std::visit(
        [&](const auto& what) {
          using What = std::decay_t<decltype(what)>;
          if constexpr (std::is_same_v<What, Action::Drive>) drive(what.instrument, what.value);
          if constexpr (std::is_same_v<What, Action::Turn>) turn(what.instrument, what.rotation);
          if constexpr (std::is_same_v<What, Action::Attribute>) attribute_events(what.wanted);
          if constexpr (std::is_same_v<What, Action::Velocity>) set_velocity(what.velocity);
          if constexpr (std::is_same_v<What, Action::Step>) take_step(what.dt, 0);
          if constexpr (std::is_same_v<What, Action::Remove>) remove(what.elements);
          if constexpr (std::is_same_v<What, Action::Open>) open_faces(what.faces);
          if constexpr (std::is_same_v<What, Action::Grasp>) take_hold(what);
          if constexpr (std::is_same_v<What, Action::Pose>) {
            pose(what.id, {what.position, what.quaternion});
          }
          if constexpr (std::is_same_v<What, Action::Release>) release(what.id);
          if constexpr (std::is_same_v<What, Action::Push>) push(what.nodes, what.force);
          if constexpr (std::is_same_v<What, Action::Move>) move(what.id, what.nodes, what.force);
          if constexpr (std::is_same_v<What, Action::Drop>) drop(what.id);
          if constexpr (std::is_same_v<What, Action::WarmUp>) warm_up();
        },
        action->what);
  } catch (const NumericalError&) {
    if (!action->failed) throw;  // it went well the first time
  }
  h.done.push_back(action);
}

/// Takes `actions` as what has been done, wherever the simulation is; true: by replaying from the
/// start.
bool Simulation::go_to(const Actions& actions, const std::shared_ptr<const Kept>& kept) {
  History& h = *history_;
  const InstrumentForces::Quiet quiet(haptics_.get());  // nobody feels the way there
  const Actions path = actions;
  const std::size_t same = common(path, h.done);
  // The latest state on the way that the backend still goes back to.
  bool back = same == path.size() && kept && go_back(*kept);
  std::size_t at = back ? path.size() : 0;
  for (std::size_t p = h.points.size(); !back && p-- > 0;) {
    const History::Point& point = h.points[p];
    if (point.actions > same || !point.kept || !go_back(*point.kept)) continue;
    back = true;
    at = point.actions;
  }
  if (!back && same == h.done.size()) {  // from here on
    back = true;
    at = same;
  }
  if (!back) {
    begin_anew();
  } else {
    std::erase_if(h.points, [&](const History::Point& p) { return p.actions >= at; });
    h.done.resize(at);
  }
  for (std::size_t i = at; i < path.size(); ++i) perform(path[i]);
  arrive();
  if (!back && !named_.empty()) backend_->prepare(named_);
  return !back;
}

void Simulation::renew_backend() {
  require_history();
  const InstrumentForces::Quiet quiet(haptics_.get());
  const Actions path = history_->done;
  begin_anew();
  for (const auto& action : path) perform(action);
  arrive();
  if (!named_.empty()) backend_->prepare(named_);
}

Mark Simulation::save() {
  require_history();
  return std::make_shared<const MarkedState>(
      MarkedState{history_->self, history_->done, keep(), now_.next_event});
}

Travel Simulation::restore(const Mark& mark) {
  require_history();
  History& h = *history_;
  if (!mark || mark->owner != h.self) throw UsageError("the mark is of another simulation");
  const std::size_t same = common(mark->actions, h.done);
  const int before = now_.next_event;
  Travel travel;
  if (same < h.done.size() || same < mark->actions.size()) {
    travel.replayed = go_to(mark->actions, mark->kept);
  }
  travel.events = std::max(0, before - now_.next_event);
  h.undone.clear();
  h.undone_broke = 0;
  return travel;
}

std::vector<std::uint8_t> Simulation::store() const {
  require_history();
  return to_bytes(history_->done, fingerprint(*problem_, backend_->info(), problem_->scene().live));
}

Travel Simulation::load(std::span<const std::uint8_t> bytes) {
  require_history();
  History& h = *history_;
  const std::uint64_t body = fingerprint(*problem_, backend_->info(), problem_->scene().live);
  const Actions actions = from_bytes(bytes, {&body, 1});
  Travel travel;
  travel.replayed = go_to(actions, nullptr);
  travel.events = now_.next_event;
  h.undone.clear();
  h.undone_broke = 0;
  return travel;
}

Travel Simulation::undo(int actions) {
  require_history();
  History& h = *history_;
  if (actions < 1 || actions > undos()) {
    throw UsageError("there are " + std::to_string(undos()) + " actions to take back, not " +
                     std::to_string(actions));
  }
  const History::Point point = h.points[h.points.size() - static_cast<std::size_t>(actions)];
  const Actions path(h.done.begin(), h.done.begin() + static_cast<std::ptrdiff_t>(point.actions));
  Actions undone(h.done.begin() + static_cast<std::ptrdiff_t>(point.actions), h.done.end());
  undone.insert(undone.end(), h.undone.begin(), h.undone.end());
  const std::size_t broke = h.undone_broke + static_cast<std::size_t>(actions);
  Travel travel;
  travel.events = now_.next_event - point.events;
  travel.replayed = go_to(path, point.kept);
  h.undone = std::move(undone);
  h.undone_broke = broke;
  return travel;
}

Travel Simulation::redo(int actions) {
  require_history();
  History& h = *history_;
  if (actions < 1 || actions > redos()) {
    throw UsageError("there are " + std::to_string(redos()) + " actions to do again, not " +
                     std::to_string(actions));
  }
  Travel travel;
  const int before = now_.next_event;
  const InstrumentForces::Quiet quiet(haptics_.get());
  // With what came after it, up to the next in which something broke: undo() has taken it too.
  for (int left = actions; !h.undone.empty();) {
    const auto action = h.undone.front();
    if (action->broke && left == 0) break;
    perform(action);
    h.undone.erase(h.undone.begin());
    if (!action->broke) continue;
    --left;
    --h.undone_broke;
  }
  arrive();
  travel.events = now_.next_event - before;
  return travel;
}

}  // namespace sunder
