// SPDX-License-Identifier: Apache-2.0
#include "solver/renewed_update.hpp"

#include "solver/load_room.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {

RenewedUpdate::RenewedUpdate(const fem::DamagedBody& body, Based first)
    : body_(body), based_(std::move(first)) {
  reserve(load_, body.problem());
}

RenewedUpdate::RenewedUpdate(const fem::DamagedBody& body, Based first, const Renewal& renewal,
                             Make make)
    : RenewedUpdate(body, std::move(first)) {
  renewal_ = renewal;
  make_ = std::move(make);
  threshold_ = renewal.first_columns;
  coming_.emplace(body, renewal.events, renewal.rest);
}

void RenewedUpdate::follow(const fem::Event& event, bool anew) {
  if (coming_->due()) take_base();
  coming_->follow();
  if (anew || !based_.follow(event)) {
    if (!rebase()) throw NumericalError("the update of the split body is singular");
  } else if (begins()) {
    coming_->start(load_, [this](const fem::DamagedBody& body, const Load& load,
                                 const linear_algebra::FactorWork& work) {
      Based based = make_(body, work);
      check_base(based, based.parted ? based.parted->body() : body, load, [](Eigen::VectorXd&) {});
      return based;
    });
  }
}

/// Elements that come with another form need no mesh of their own.
bool RenewedUpdate::can_be_renewed() const {
  return body_.forms().new_nodes().empty() || fem::can_be_parted(body_);
}

bool RenewedUpdate::begins() const {
  const Eigen::Index columns = based_.deferred->rank() + based_.deferred->offsets().size();
  return !coming_->making() && static_cast<std::size_t>(columns) > threshold_ && can_be_renewed();
}

bool RenewedUpdate::rebase() {
  if (!coming_ || !can_be_renewed()) return false;
  coming_->give_up();
  saved_ms_ = saved_ms();
  based_ = {};  // frees the old base first
  based_ = make_(body_, {});
  renewed();
  return true;
}

void RenewedUpdate::take_base() {
  const double saved = saved_ms();
  if (!coming_->take(based_)) return;  // what there is still holds; the next event tries again
  saved_ms_ = saved;
  renewed();
}

void RenewedUpdate::renewed() {
  threshold_ = renewal_.columns;
  ++bases_;
}

}  // namespace sunder::solver
