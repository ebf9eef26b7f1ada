// SPDX-License-Identifier: Apache-2.0
#include "app/system/signals.hpp"

#include <csignal>
#include <ctime>

namespace sunder::app::system {
namespace {

sigset_t watched() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

}  // namespace

void hold_signals() noexcept {
  const sigset_t set = watched();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

bool await_signal(std::chrono::milliseconds limit) noexcept {
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

void wake(std::thread& waiting) noexcept { pthread_kill(waiting.native_handle(), SIGTERM); }

}  // namespace sunder::app::system
