// SPDX-License-Identifier: Apache-2.0
#include "solver/renewed_update.hpp"

#include <new>

#include "solver/load_room.hpp"
#include "solver/new_base_timer.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {

RenewedUpdate::RenewedUpdate(const fem::DamagedBody& body, Based first)
    : body_(body), based_(std::move(first)) {
  reserve(start_load_, body.problem());
  reserve(load_, body.problem());
}

RenewedUpdate::RenewedUpdate(const fem::DamagedBody& body, Based first, const Renewal& renewal,
                             Make make)
    : RenewedUpdate(body, std::move(first)) {
  renewal_ = renewal;
  make_ = std::move(make);
  threshold_ = renewal.first_columns;
  coming_.emplace(body, renewal.events, renewal.rest, renewal.events_at_once == 0);
}

void RenewedUpdate::follow(const fem::Event& event, bool anew) {
  if (coming_->due()) renewal_.events_at_once == 0 ? take_base() : take_made();
  coming_->follow();
  if (anew || !based_.follow(event)) {
    if (!rebase()) throw NumericalError("the update of the split body is singular");
  } else if (event.of_grips()) {
    based_.check = {};  // it was of loads by other grips
  } else if (begins()) {
    start_load_ = load_;
    start_events_ = body_.events();
    coming_->start(load_, checked());
  }
}

Based RenewedUpdate::make_checked(const fem::DamagedBody& body, const Load& load,
                                  const linear_algebra::FactorWork& work) const {
  Based based = make_(body, work);
  check_base(based, based.parted ? based.parted->body() : body, load, [](Eigen::VectorXd&) {});
  return based;
}

/// Of one pointer, so that a frame in which a base begins allocates nothing.
MakeBase RenewedUpdate::checked() const {
  return [this](const fem::DamagedBody& body, const Load& load,
                const linear_algebra::FactorWork& work) { return make_checked(body, load, work); };
}

RenewedUpdate::State RenewedUpdate::state() const {
  State state{based_, {}, bases_, threshold_, based_.laid_over().events(), false, 0, {}, load_};
  based_.laid_over().remember();
  if (based_.parted) state.parted = based_.parted->state();
  if (!coming_ || !coming_->making()) return state;
  state.making = true;
  state.start = start_events_;
  state.load = start_load_;
  return state;
}

void RenewedUpdate::stop(std::size_t events) {
  made_.reset();
  if (coming_) coming_->go_back(events);
}

void RenewedUpdate::go_back(const State& state) {
  saved_ms_ = saved_ms();
  based_ = state.based;
  if (state.parted) based_.parted->restore(*state.parted);
  saved_ms_ -= based_.laid_over().saved_ms();
  bases_ = state.bases;
  threshold_ = state.threshold;
  based_.laid_over().take_back(based_.laid_over().events() - state.laid);
  load_ = state.loaded;
  if (!state.making) return;
  start_load_ = state.load;
  start_events_ = state.start;
  coming_->start_again(state.start, state.load, checked());
}

/// Elements that come with another form need no mesh of their own.
bool RenewedUpdate::can_be_renewed() const {
  return body_.forms().new_nodes().empty() || fem::can_be_parted(body_);
}

bool RenewedUpdate::begins() const {
  const Deferred& deferred = based_.laid_over();
  const auto own = static_cast<Index>(body_.forms().own_gripped().size());
  // A base has unit vectors of all that is gripped, which is no reason for the next one.
  const Eigen::Index columns =
      deferred.rank() - (deferred.grips() - own) + deferred.offsets().size();
  // The load is the last frame's: since then nothing may have been grasped.
  const bool fits = load_.displacements.empty() ||
                    load_.displacements.size() == static_cast<std::size_t>(deferred.grips());
  return !held_ && !coming_->making() && !made_ && static_cast<std::size_t>(columns) > threshold_ &&
         fits && can_be_renewed();
}

bool RenewedUpdate::rebase() {
  if (!coming_ || !can_be_renewed()) return false;
  const NewBaseTimer timer(new_bases_);
  coming_->give_up();
  saved_ms_ = saved_ms();
  made_.reset();
  based_ = {};  // frees the old base first
  based_ = make_(body_, linear_algebra::work_at_once());
  renewed();
  return true;
}

void RenewedUpdate::take_base() {
  const double saved = saved_ms();
  if (!coming_->take(based_)) return;  // what there is still holds; the next event tries again
  saved_ms_ = saved;
  ++new_bases_.count;
  renewed();
}

void RenewedUpdate::take_made() {
  Based made;
  if (!coming_->take(made)) return;  // as in take_base()
  made_ = std::move(made);
  made_events_ = start_events_;
}

/// An event more. False: it cannot be followed.
bool RenewedUpdate::follow_made() {
  body_.read(made_events_, event_);
  const fem::Event event(event_);
  if (event.of_grips()) made_->check = {};  // it was of loads by other grips
  try {
    if (!made_->follow(event)) return false;
  } catch (const NumericalError&) {
    return false;
  } catch (const std::bad_alloc&) {
    return false;
  }
  ++made_events_;
  return true;
}

void RenewedUpdate::catch_up() {
  if (!made_) return;
  for (int i = 0; i < renewal_.events_at_once && made_events_ < body_.events(); ++i) {
    if (follow_made()) continue;
    coming_->free(std::move(*made_));  // what there is still holds
    made_.reset();
    return;
  }
  if (made_events_ < body_.events()) return;
  saved_ms_ = saved_ms();
  std::swap(based_, *made_);
  coming_->free(std::move(*made_));
  made_.reset();
  ++new_bases_.count;
  renewed();
}

void RenewedUpdate::renewed() {
  threshold_ = renewal_.columns;
  ++bases_;
}

}  // namespace sunder::solver
