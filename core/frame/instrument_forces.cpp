// SPDX-License-Identifier: Apache-2.0
#include "sunder/instrument_forces.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>

#include "frame/quaternion.hpp"
#include "sunder/error.hpp"

namespace sunder {
namespace {

Index unknowns_of(const HeldGrip& grip) { return 3 * static_cast<Index>(grip.moved.size()); }

}  // namespace

InstrumentForces::InstrumentForces(std::span<const double> anchors)
    : size_(static_cast<Index>(anchors.size())), anchors_(size_) {
  std::copy(anchors.begin(), anchors.end(), anchors_.begin());
  for (Copy& copy : handover_.copies()) {
    copy.of.l.setZero(size_, size_);
    copy.of.u_0.setZero(size_);
    for (Eigen::VectorXd* v : {&copy.of.held, &copy.d, &copy.h, &copy.jump}) v->setZero(size_);
  }
  last_ = handover_.next().of;
}

void InstrumentForces::publish(const Eigen::Ref<const Eigen::MatrixXd>& l,
                               const Eigen::Ref<const Eigen::VectorXd>& u_0,
                               std::span<const double> held) {
  const Eigen::Index all = u_0.size();
  if (l.rows() != all || l.cols() != all ||
      (!held.empty() && held.size() != static_cast<std::size_t>(all))) {
    throw UsageError("instrument forces have one row per gripped dof");
  }
  const bool sound =
      u_0.allFinite() && l.diagonal().allFinite() && (l.diagonal().array() > 0).all();
  if (!sound) return;
  last_.l = l;
  last_.u_0 = u_0;
  if (held.empty()) {
    last_.held = u_0;
  } else {
    last_.held = Eigen::Map<const Eigen::VectorXd>(held.data(), all);
  }
  last_.grips = grips_;
  last_.number = frames_.fetch_add(1, std::memory_order_relaxed) + 1;
  last_.step = step_;
  last_.found = Clock::now();
  last_.filled = true;
  hand_over();
}

/// Whether the gripped unknowns are those of the grips that it is said to hold.
bool InstrumentForces::fits(const Solution& solution) const {
  if (!solution.grips) return solution.u_0.size() >= size_;
  auto all = static_cast<Index>(solution.grips->own.size());
  for (const HeldGrip& grip : solution.grips->grips) all += unknowns_of(grip);
  return all == solution.u_0.size();
}

/// How many of the gripped unknowns are the scene's: the first ones.
std::size_t InstrumentForces::own_of(const Solution& solution) const {
  return solution.grips ? solution.grips->own.size() : static_cast<std::size_t>(size_);
}

/// Of the i-th of them: its place among all that the scene's grips held at first.
Index InstrumentForces::own_place(const Solution& solution, std::size_t i) const {
  return solution.grips ? solution.grips->own[i] : static_cast<Index>(i);
}

void InstrumentForces::hand_over() {
  waits_ = quiet_ > 0;
  if (waits_ || !fits(last_)) return;
  Copy& copy = handover_.next();
  copy.of = last_;
  for (Eigen::VectorXd* v : {&copy.d, &copy.h, &copy.jump}) v->resize(last_.u_0.size());
  handover_.hand_over();
}

void InstrumentForces::describe(std::vector<HeldGrip> grips, std::vector<Index> own) {
  grips_ = std::make_shared<const Held>(Held{std::move(grips), std::move(own)});
}

void InstrumentForces::publish_again() {
  last_.grips = grips_;
  if (last_.filled && !fits(last_)) last_.filled = false;
  hand_over();
}

void InstrumentForces::withdraw() {
  last_.filled = false;
  hand_over();
}

void InstrumentForces::let_go(int grip) {
  if (!last_.filled || !last_.grips) return;
  const auto& all = last_.grips->grips;
  if (std::ranges::find(all, grip, &HeldGrip::id) == all.end()) return;
  Held left{{}, last_.grips->own};
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < left.own.size(); ++i) rows.push_back(static_cast<Eigen::Index>(i));
  for (const HeldGrip& of : all) {
    if (of.id == grip) continue;
    left.grips.push_back(of);
    left.grips.back().first = rows.size();
    for (Index i = 0; i < unknowns_of(of); ++i) {
      rows.push_back(static_cast<Eigen::Index>(of.first) + i);
    }
  }
  keep_rows(rows, std::move(left));
}

void InstrumentForces::let_go(std::vector<Index> own) {
  if (!last_.filled || !last_.grips) return;
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < last_.grips->own.size(); ++i) {
    if (std::ranges::binary_search(own, last_.grips->own[i])) {
      rows.push_back(static_cast<Eigen::Index>(i));
    }
  }
  Held left{{}, std::move(own)};
  for (const HeldGrip& of : last_.grips->grips) {
    left.grips.push_back(of);
    left.grips.back().first = rows.size();
    for (Index i = 0; i < unknowns_of(of); ++i) {
      rows.push_back(static_cast<Eigen::Index>(of.first) + i);
    }
  }
  keep_rows(rows, std::move(left));
}

/// Without a grip the others' compliance and displacement are what they were: its rows go.
void InstrumentForces::keep_rows(const std::vector<Eigen::Index>& rows, Held left) {
  const Eigen::MatrixXd l = last_.l.triangularView<Eigen::Lower>();
  const Eigen::MatrixXd compliance = l(rows, Eigen::all) * l(rows, Eigen::all).transpose();
  const Eigen::LLT<Eigen::MatrixXd> factor(compliance);
  last_.filled =
      rows.empty() || (factor.info() == Eigen::Success && factor.matrixLLT().allFinite());
  last_.l = factor.matrixLLT();
  last_.u_0 = Eigen::VectorXd(last_.u_0(rows));
  last_.held = Eigen::VectorXd(last_.held(rows));
  last_.grips = std::make_shared<const Held>(std::move(left));
  hand_over();
}

InstrumentForces::Quiet::Quiet(InstrumentForces* forces) : forces_(forces) {
  if (forces_) ++forces_->quiet_;
}

InstrumentForces::Quiet::~Quiet() {
  if (!forces_ || --forces_->quiet_ > 0 || !forces_->waits_) return;
  forces_->hand_over();
}

const HeldGrip* InstrumentForces::find(const Copy& copy, int grip) const {
  if (!copy.of.grips) return nullptr;
  for (const HeldGrip& of : copy.of.grips->grips) {
    if (of.id == grip) return &of;
  }
  return nullptr;
}

/// copy.h: forces by a solution; false where they are not finite.
bool InstrumentForces::evaluate(Copy& copy, std::span<const double> displacements,
                                std::span<const Hand> hands) const {
  Eigen::VectorXd &d = copy.d, &h = copy.h;
  d = copy.of.held;
  const std::size_t own = own_of(copy.of);
  for (std::size_t i = 0; i < own && !displacements.empty(); ++i) {
    d[static_cast<Eigen::Index>(i)] =
        displacements[static_cast<std::size_t>(own_place(copy.of, i))];
  }
  for (const Hand& hand : hands) {
    const HeldGrip* grip = find(copy, hand.grip);
    if (!grip) continue;
    const Vec3 shift = hand.position - grip->centre;
    const Mat3 turn = grip->rigid ? turn_by(hand.quaternion) : Mat3::Zero();
    for (std::size_t n = 0; n < grip->moved.size(); ++n) {
      d.segment<3>(static_cast<Eigen::Index>(grip->first + 3 * n)) =
          grip->moved[n] + shift + turn * grip->arms[n];
    }
  }
  if (!d.allFinite()) return false;
  h = d - copy.of.u_0;
  copy.of.l.triangularView<Eigen::Lower>().solveInPlace(h);
  copy.of.l.transpose().triangularView<Eigen::Upper>().solveInPlace(h);
  for (std::size_t i = 0; i < own; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    h[at] -= anchors_[own_place(copy.of, i)] * d[at];  // whose share is no reaction
  }
  return h.allFinite();
}

/// now.h = share now.h + (1 - share) (before.h + jump), grip by grip.
void InstrumentForces::add_before(Copy& now, const Copy& before, double share,
                                  bool with_jump) const {
  now.h *= share;
  if (with_jump) now.h += (1 - share) * now.jump;
  for (std::size_t i = 0, j = 0; i < own_of(now.of); ++i) {
    while (j < own_of(before.of) && own_place(before.of, j) < own_place(now.of, i)) ++j;
    if (j == own_of(before.of)) break;
    if (own_place(before.of, j) != own_place(now.of, i)) continue;
    now.h[static_cast<Eigen::Index>(i)] += (1 - share) * before.h[static_cast<Eigen::Index>(j)];
  }
  if (!now.of.grips) return;
  for (const HeldGrip& grip : now.of.grips->grips) {
    const HeldGrip* was = find(before, grip.id);
    if (!was) continue;
    now.h.segment(static_cast<Eigen::Index>(grip.first), unknowns_of(grip)) +=
        (1 - share) * before.h.segment(static_cast<Eigen::Index>(was->first), unknowns_of(grip));
  }
}

double InstrumentForces::share(Clock::time_point now) const {
  const double over = blend_ms_.load(std::memory_order_relaxed);
  if (!blends_ || !(over > 0)) return 1;
  return std::clamp(std::chrono::duration<double, std::milli>(now - since_).count() / over, 0.0,
                    1.0);
}

/// Takes the new solution. In the middle of a blend the force as it is goes on from here: what it
/// differs by from the map that becomes the former one fades with that.
bool InstrumentForces::take_news(std::span<const double> displacements, std::span<const Hand> hands,
                                 Clock::time_point now) {
  const bool blending = share(now) < 1 && answer(displacements, hands, now);
  handover_.take();
  Copy &current = handover_.read(0), &before = handover_.read(1);
  since_ = now;
  blends_ = current.of.filled && before.of.filled;
  if (!blends_) return current.of.filled;
  current.jump.setZero();
  if (!blending) return true;
  current.h.setZero();
  add_before(current, before, 0, false);  // as it is
  current.jump = current.h;
  if (!evaluate(before, displacements, hands)) return false;
  current.h.setZero();
  add_before(current, before, 0, false);
  current.jump -= current.h;
  return true;
}

/// read(0).h: the forces now, blended; false where they are not finite.
bool InstrumentForces::answer(std::span<const double> displacements, std::span<const Hand> hands,
                              Clock::time_point now) {
  Copy& current = handover_.read(0);
  if (!evaluate(current, displacements, hands)) return false;
  const double part = share(now);
  if (part >= 1) return true;
  Copy& before = handover_.read(1);
  if (!evaluate(before, displacements, hands)) return false;
  add_before(current, before, part, true);
  return current.h.allFinite();
}

void InstrumentForces::tell(Hand& hand) const {
  const Copy& copy = handover_.read(0);
  const HeldGrip* grip = find(copy, hand.grip);
  if (!grip) return;
  hand.held = true;
  const Mat3 turn = grip->rigid ? turn_by(hand.quaternion) : Mat3::Zero();
  for (std::size_t n = 0; n < grip->arms.size(); ++n) {
    const Vec3 force = copy.h.segment<3>(static_cast<Eigen::Index>(grip->first + 3 * n));
    hand.force += force;
    hand.torque += Vec3(grip->arms[n] + turn * grip->arms[n]).cross(force);
  }
}

Felt InstrumentForces::feel(std::span<const double> displacements, std::span<double> forces,
                            std::span<Hand> hands, Clock::time_point now) {
  const auto own = static_cast<std::size_t>(size_);
  if ((!displacements.empty() && displacements.size() != own) ||
      (!forces.empty() && forces.size() != own)) {
    throw UsageError("instrument forces need one value per gripped dof");
  }
  Felt felt;
  const auto none = [&](FeltState state) {
    std::ranges::fill(forces, 0.0);
    for (Hand& hand : hands) hand.held = false, hand.force.setZero(), hand.torque.setZero();
    felt.state = state;
    return felt;
  };
  if (gone_.load(std::memory_order_acquire)) return none(FeltState::gone);
  bool finite = std::ranges::all_of(displacements, [](double d) { return std::isfinite(d); });
  for (const Hand& hand : hands) {
    finite = finite && hand.position.allFinite() && names_a_turn(hand.quaternion);
  }
  if (!finite) return none(FeltState::overflow);
  if (handover_.news() && !take_news(displacements, hands, now) && handover_.read().of.filled) {
    return none(FeltState::overflow);
  }
  const Solution& of = handover_.read().of;
  if (!of.filled) return none(FeltState::waiting);
  if (!answer(displacements, hands, now)) return none(FeltState::overflow);
  felt.state = FeltState::live;
  felt.solution = of.number;
  felt.step = of.step;
  felt.age_ms = std::max(0.0, std::chrono::duration<double, std::milli>(now - of.found).count());
  felt.share = share(now);
  std::ranges::fill(forces, 0.0);
  for (std::size_t i = 0; i < own_of(of) && !forces.empty(); ++i) {
    forces[static_cast<std::size_t>(own_place(of, i))] =
        handover_.read().h[static_cast<Eigen::Index>(i)];
  }
  for (Hand& hand : hands) {
    hand.held = false, hand.force.setZero(), hand.torque.setZero();
    tell(hand);
  }
  return felt;
}

bool InstrumentForces::forces(std::span<const double> displacements, std::span<double> forces) {
  if (displacements.size() != static_cast<std::size_t>(size_) ||
      forces.size() != displacements.size()) {
    throw UsageError("instrument forces need one value per gripped dof");
  }
  return feel(displacements, forces, {}).state == FeltState::live;
}

}  // namespace sunder
