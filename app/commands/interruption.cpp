// SPDX-License-Identifier: Apache-2.0
#include "app/commands/interruption.hpp"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <utility>

#include "app/system/process.hpp"
#include "app/system/signals.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

constexpr const char* kAgain = "interrupted again: the results so far are dropped";
constexpr const char* kTooLate = "interrupted again: all results were written before, and stay";

/// Past the streams: a thread that was left behind may hold their locks.
void say(const std::string& sentence) {
  const bool terminal = system::error_is_terminal();  // where a line of progress may stand
  system::write_error((terminal ? "\r\033[K" : "") + ("sunder: " + sentence) + "\n");
}

int carry_out(const std::function<int()>& results) {
  try {
    return results();
  } catch (const Error& error) {
    say(std::string("error: ") + error.what());
    return error.exit_code();
  } catch (const std::exception& error) {
    say(std::string("internal error: ") + error.what());
    return 1;
  }
}

}  // namespace

Interruption::Interruption() {
  system::hold_signals();
  duty_.nothing = "nothing was written";
  thread_ = std::thread([this] { watch(); });
}

Interruption::~Interruption() {
  over(0);
  ended_ = true;
  system::wake(thread_);
  thread_.join();
}

void Interruption::stay_unless_free(std::unique_lock<std::mutex>& lock) const {
  if (!forced_) return;
  lock.unlock();
  system::stay();
}

Interruption::Since Interruption::since_signal() const {
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - came_;
  return {passed.count(), system::processor_seconds() - processor_at_};
}

/// What still computes shall not take the processors from what writes the results.
void Interruption::lower_priority_of_others() const {
  system::lower_priority_of_others({system::thread_id(), watcher_.load()});
}

Interruption::Duty Interruption::expect(const std::function<Duty()>& make) {
  std::unique_lock lock(mutex_);
  stay_unless_free(lock);
  return std::exchange(duty_, make());
}

void Interruption::claim() {
  std::unique_lock lock(mutex_);
  stay_unless_free(lock);
  claimed_ = true;
  lock.unlock();
  if (requested_) lower_priority_of_others();
}

void Interruption::over(int exit_code) {
  std::unique_lock lock(mutex_);
  stay_unless_free(lock);
  if (!over_) over_ = exit_code;
}

void Interruption::leave(int exit_code) {
  {
    const std::lock_guard lock(mutex_);  // not to be had while results are dropped
    over_ = exit_code;
  }
  std::cout.flush();
  std::fflush(stdout);
  std::_Exit(exit_code);
}

void Interruption::watch() {
  watcher_ = system::thread_id();
  static_cast<void>(system::await_signal({}));
  if (ended_) return;
  first();
  while (!ended_) {
    static_cast<void>(system::await_signal({}));
    if (ended_) return;
    drop(kAgain);
  }
}

void Interruption::first() {
  std::unique_lock lock(mutex_);
  came_ = std::chrono::steady_clock::now();
  processor_at_ = system::processor_seconds();
  requested_ = true;
  if (claimed_ && !over_) return;
  const bool results = !over_ && duty_.results;
  const std::chrono::milliseconds grace = duty_.grace;
  const std::string nothing = duty_.nothing;
  lock.unlock();
  if (!results) {
    drop("interrupted: " + nothing);
  } else if (grace.count() > 0 && system::await_signal(grace)) {
    if (!ended_) drop(kAgain);
  } else {
    write_without_it();
  }
}

void Interruption::write_without_it() {
  const std::lock_guard lock(mutex_);
  if (claimed_ || over_) return;
  forced_ = true;
  lower_priority_of_others();
  std::thread([this, results = duty_.results] { leave(carry_out(results)); }).detach();
}

void Interruption::drop(const std::string& what) {
  const std::lock_guard lock(mutex_);  // never given back
  if (over_) std::_Exit(*over_);
  const bool dropped = !duty_.drop || duty_.drop();
  say(dropped ? what : kTooLate);
  std::_Exit(kInterruptedExit);
}

}  // namespace sunder::app
