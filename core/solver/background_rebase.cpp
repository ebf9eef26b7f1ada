// SPDX-License-Identifier: Apache-2.0
#include "solver/background_rebase.hpp"

#include <chrono>
#include <exception>
#include <numeric>

namespace sunder::solver {

void check_base(Based& based, const fem::DamagedBody& body, const Load& load,
                const std::function<void(Eigen::VectorXd&)>& complete) {
  Deferred& deferred = *based.deferred;
  const Forces forces{load.force_dofs, load.forces};
  Eigen::VectorXd u, du, r;
  deferred.solve(forces, load.displacements, u);
  complete(u);
  body.apply(u, r);
  r = -r;
  for (std::size_t i = 0; i < load.forces.size(); ++i) r[load.force_dofs[i]] += load.forces[i];
  for (Index d : body.forms().gripped()) r[d] = 0;
  std::vector<Index> all(static_cast<std::size_t>(r.size()));
  std::iota(all.begin(), all.end(), 0);
  deferred.correct({all, {r.data(), all.size()}}, du);
  complete(du);
  const double stress = body.largest_stress(du), largest = body.largest_stress(u);
  based.check = {load, stress / r.norm(), stress == 0 ? 0.0 : stress / largest};
  deferred.solve(forces, load.displacements, u);
}

BackgroundRebase::BackgroundRebase(const fem::DamagedBody& body, int events,
                                   std::chrono::milliseconds rest)
    : of_(body),
      events_(events),
      rest_(rest),
      body_(body),
      recorded_(body.events()),
      at_(body.events()) {
  const auto unknowns = static_cast<std::size_t>(body.problem().dof_count());
  load_.force_dofs.reserve(unknowns);
  load_.forces.reserve(unknowns);
  load_.displacements.reserve(body.problem().gripped_dofs().size());
  thread_ = std::thread([this] { run(); });
}

BackgroundRebase::~BackgroundRebase() {
  unwanted_ = true;
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  asked_.notify_one();
  thread_.join();
}

void BackgroundRebase::follow() {
  {
    const std::lock_guard lock(mutex_);
    recorded_ = of_.events();
  }
  if (!making_) return;
  ++followed_;
  asked_.notify_one();
}

void BackgroundRebase::start(const Load& load, MakeBase make) {
  making_ = true;
  followed_ = 0;
  {
    const std::lock_guard lock(mutex_);
    load_ = load;
    make_ = std::move(make);
    phase_ = Phase::asked;
    start_ = recorded_;
  }
  asked_.notify_one();
}

bool BackgroundRebase::take(Based& based) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  making_ = false;
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return phase_ == Phase::following && at_ == recorded_; });
  waited_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  phase_ = Phase::idle;
  if (!result_.deferred) return false;
  old_ = std::move(based);
  based = std::move(result_);
  result_ = {};
  lock.unlock();
  asked_.notify_one();
  return true;
}

void BackgroundRebase::give_up() {
  making_ = false;
  unwanted_ = true;
  std::unique_lock lock(mutex_);
  phase_ = Phase::idle;
  done_.wait(lock, [this] { return !busy_; });
  phase_ = Phase::idle;
  result_ = {};
  unwanted_ = false;
}

void BackgroundRebase::go_back(std::size_t events) {
  give_up();
  const std::lock_guard lock(mutex_);
  if (body_.events() > events) body_ = body_.as_of(events);
  recorded_ = events;
  at_ = std::min(at_, events);
}

void BackgroundRebase::start_again(std::size_t start, const Load& load, MakeBase make) {
  making_ = true;
  {
    const std::lock_guard lock(mutex_);
    if (body_.events() > start) body_ = body_.as_of(start);
    load_ = load;
    make_ = std::move(make);
    phase_ = Phase::asked;
    start_ = start;
    followed_ = static_cast<int>(recorded_ - start);
  }
  asked_.notify_one();
}

bool BackgroundRebase::work_waits() const {
  return quit_ || old_.deferred || phase_ == Phase::asked ||
         (phase_ == Phase::following && at_ < recorded_);
}

void BackgroundRebase::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    asked_.wait(lock, [this] { return work_waits(); });
    if (rest_.count() > 0) {
      lock.unlock();
      std::this_thread::sleep_for(rest_);
      lock.lock();
      if (!work_waits()) continue;
    }
    if (quit_) return;
    busy_ = true;
    if (old_.deferred) {
      const Based old = std::move(old_);
      old_ = {};
      lock.unlock();
    } else if (phase_ == Phase::asked) {
      make(lock);
    } else {
      follow_next(lock);
    }
    if (!lock.owns_lock()) lock.lock();
    busy_ = false;
    done_.notify_one();
  }
}

void BackgroundRebase::make(std::unique_lock<std::mutex>& lock) {
  at_ = start_;
  const MakeBase make = std::move(make_);
  lock.unlock();
  body_.follow(start_);
  Based based;
  try {
    based = make(body_, load_, {.stop = &unwanted_});
  } catch (const std::exception&) {
    // Out of memory, not definite or unwanted: it stays empty, and the frame that takes it decides.
  }
  lock.lock();
  result_ = std::move(based);
  if (phase_ == Phase::asked) phase_ = Phase::following;
}

void BackgroundRebase::follow_next(std::unique_lock<std::mutex>& lock) {
  const std::size_t next = at_ + 1;
  lock.unlock();
  body_.read(at_, event_);
  body_.follow(next);
  try {
    if (fem::Event(event_).of_grips()) result_.check = {};  // it was of loads by other grips
    if (result_.deferred && !result_.follow(event_)) result_ = {};
  } catch (const std::exception&) {
    result_ = {};  // as in make()
  }
  lock.lock();
  at_ = next;
}

}  // namespace sunder::solver
