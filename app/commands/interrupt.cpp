// SPDX-License-Identifier: Apache-2.0
#include "app/commands/interrupt.hpp"

#include <csignal>

namespace sunder::app {
namespace {

volatile std::sig_atomic_t requested_signal = 0;

void remember(int signal) { requested_signal = signal; }

void install(void (*handler)(int), int flags) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  requested_signal = 0;
  install(remember, static_cast<int>(SA_RESTART | SA_RESETHAND));
}

InterruptGuard::~InterruptGuard() { install(SIG_DFL, 0); }

bool InterruptGuard::requested() { return requested_signal != 0; }

}  // namespace sunder::app
