// SPDX-License-Identifier: Apache-2.0
#include "app/commands/interruption.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <iostream>
#include <utility>

#include "sunder/error.hpp"

namespace sunder::app {
namespace {

constexpr const char* kAgain = "interrupted again: the results so far are dropped";
constexpr const char* kTooLate = "interrupted again: all results were written before, and stay";

sigset_t watched() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

/// Past the streams: a thread that was left behind may hold their locks.
void say(const std::string& sentence) {
  const bool terminal = ::isatty(STDERR_FILENO) == 1;  // where a line of progress may stand
  const std::string line = (terminal ? "\r\033[K" : "") + ("sunder: " + sentence) + "\n";
  if (::write(STDERR_FILENO, line.data(), line.size()) < 0) return;  // nobody is left to tell
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

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

void hold_signals() noexcept {
  const sigset_t set = watched();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

Interruption::Interruption() {
  hold_signals();
  duty_.nothing = "nothing was written";
  thread_ = std::thread([this] { watch(); });
}

Interruption::~Interruption() {
  over(0);
  ended_ = true;
  pthread_kill(thread_.native_handle(), SIGTERM);  // wakes it
  thread_.join();
}

void Interruption::stay_unless_free(std::unique_lock<std::mutex>& lock) const {
  if (!forced_) return;
  lock.unlock();
  for (;;) ::pause();
}

Interruption::Since Interruption::since_signal() const {
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - came_;
  return {passed.count(), processor_seconds() - processor_at_};
}

/// What still computes shall not take the processors from what writes the results. It is not sent
/// to the end of the queue: the last thread that ends gives the process's memory back, which takes
/// ten seconds at the lowest priority on a busy machine.
void Interruption::lower_priority_of_others() const {
  constexpr int kLower = 5;  // a quarter of the processor beside what writes
  const int priority = ::getpriority(PRIO_PROCESS, 0) + kLower;
  const auto own = static_cast<id_t>(::gettid()), watcher = static_cast<id_t>(watcher_.load());
  std::error_code none;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", none)) {
    const auto id = static_cast<id_t>(std::stoul(task.path().filename().string()));
    if (id != own && id != watcher) ::setpriority(PRIO_PROCESS, id, priority);
  }
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

/// Waits for a signal; false when the time is over first. Zero: without end.
bool Interruption::await(std::chrono::milliseconds limit) const {
  const sigset_t set = watched();
  const auto deadline = std::chrono::steady_clock::now() + limit;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(
        deadline - std::chrono::steady_clock::now());
    if (limit.count() > 0 && left.count() <= 0) return false;
    const timespec time{left.count() / 1'000'000'000, left.count() % 1'000'000'000};
    if (sigtimedwait(&set, nullptr, limit.count() > 0 ? &time : nullptr) > 0) return true;
  }
}

void Interruption::watch() {
  watcher_ = ::gettid();
  static_cast<void>(await({}));
  if (ended_) return;
  first();
  while (!ended_) {
    static_cast<void>(await({}));
    if (ended_) return;
    drop(kAgain);
  }
}

void Interruption::first() {
  std::unique_lock lock(mutex_);
  came_ = std::chrono::steady_clock::now();
  processor_at_ = processor_seconds();
  requested_ = true;
  if (claimed_ && !over_) return;
  const bool results = !over_ && duty_.results;
  const std::chrono::milliseconds grace = duty_.grace;
  const std::string nothing = duty_.nothing;
  lock.unlock();
  if (!results) {
    drop("interrupted: " + nothing);
  } else if (grace.count() > 0 && await(grace)) {
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
