// SPDX-License-Identifier: Apache-2.0
#include "solver/background_rebase.hpp"

#include <chrono>
#include <exception>
#include <numeric>

#include "sunder/error.hpp"

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

Deferred& Based::laid_over() const {
  if (!deferred) {
    throw NumericalError(
        "a step before left the body as it cannot be solved; take that step back, or begin anew");
  }
  return *deferred;
}

BackgroundRebase::BackgroundRebase(const fem::DamagedBody& body, int events,
                                   std::chrono::milliseconds rest, bool follows)
    : of_(body),
      events_(events),
      follows_(follows),
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
  {
    const std::lock_guard lock(mutex_);
    unwanted_ = true;
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
  const std::lock_guard lock(mutex_);
  ask(load, std::move(make), recorded_);
}

void BackgroundRebase::ask(const Load& load, MakeBase make, std::size_t start) {
  ++job_;
  load_ = load;
  make_ = std::move(make);
  phase_ = Phase::asked;
  start_ = start;
  asked_.notify_one();
}

bool BackgroundRebase::take(Based& based) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  making_ = false;
  std::unique_lock lock(mutex_);
  done_.wait(lock,
             [this] { return phase_ == Phase::following && (!follows_ || at_ == recorded_); });
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

void BackgroundRebase::free(Based&& based) {
  {
    const std::lock_guard lock(mutex_);
    old_ = std::move(based);
  }
  asked_.notify_one();
}

/// Whatever is in work is of no use any more.
void BackgroundRebase::drop() {
  making_ = false;
  ++job_;
  unwanted_ = true;
  phase_ = Phase::idle;
}

void BackgroundRebase::give_up() {
  Lock lock(mutex_);
  drop();
  done_.wait(lock, [this] { return !busy_; });
  result_ = {};
}

void BackgroundRebase::go_back(std::size_t events) {
  Based unread;
  {
    const std::lock_guard lock(mutex_);
    drop();
    recorded_ = events;
    astray_ = true;
    std::swap(result_, old_.deferred ? unread : old_);  // the thread frees it, if it can
  }
  asked_.notify_one();
}

void BackgroundRebase::start_again(std::size_t start, const Load& load, MakeBase make) {
  making_ = true;
  const std::lock_guard lock(mutex_);
  followed_ = static_cast<int>(recorded_ - start);
  ask(load, std::move(make), start);
}

bool BackgroundRebase::work_waits() const {
  return quit_ || old_.deferred || phase_ == Phase::asked ||
         (phase_ == Phase::following && follows_ && at_ < recorded_);
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
    unwanted_ = false;
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

/// The event after the last one that body_ has followed, into event_; false: the job is dropped.
/// Only so long as it is not, the record holds what it held when the job was asked for.
bool BackgroundRebase::read_next(std::uint64_t job) {
  if (job != job_) return false;
  body_.read(body_.events(), event_);
  return true;
}

void BackgroundRebase::make(Lock& lock) {
  const std::uint64_t job = job_;
  const std::size_t start = at_ = start_;
  const MakeBase make = std::move(make_);
  load_of_job_ = load_;
  if (astray_) body_ = body_.as_of(0);
  astray_ = false;
  while (body_.events() < start) {
    if (!read_next(job)) return;
    lock.unlock();
    body_.follow(fem::Event(event_));
    lock.lock();
  }
  lock.unlock();
  Based based;
  try {
    based = make(body_, load_of_job_, linear_algebra::work_beside(unwanted_));
  } catch (const std::exception&) {
    // Out of memory, not definite or unwanted: it stays empty, and the frame that takes it decides.
  }
  lock.lock();
  if (job == job_) {
    result_ = std::move(based);
    phase_ = Phase::following;
  } else {
    lock.unlock();  // it takes a while to free
  }
}

void BackgroundRebase::follow_next(Lock& lock) {
  const std::uint64_t job = job_;
  if (!read_next(job)) return;
  Based based = std::move(result_);
  result_ = {};
  lock.unlock();
  body_.follow(fem::Event(event_));
  try {
    if (fem::Event(event_).of_grips()) based.check = {};  // it was of loads by other grips
    if (based.deferred && !based.follow(event_)) based = {};
  } catch (const std::exception&) {
    based = {};  // as in make()
  }
  lock.lock();
  if (job == job_) {
    result_ = std::move(based);
    ++at_;
  } else {
    lock.unlock();
  }
}

}  // namespace sunder::solver
